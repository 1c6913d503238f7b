// SPDX-License-Identifier: BSD-3-Clause
#include "board_detection.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)
#define VERNIER_NEW_ARUCO 1
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#define VERNIER_NEW_ARUCO 0
#include <opencv2/aruco/charuco.hpp>
#endif

#include "vernier/core/check.hpp"

namespace support {

namespace {

namespace vn = vernier;

int dictionary_number(const std::string& name) {
  static const std::map<std::string, int> known{
      {"DICT_4X4_50", cv::aruco::DICT_4X4_50},   {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
      {"DICT_4X4_250", cv::aruco::DICT_4X4_250}, {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
      {"DICT_5X5_50", cv::aruco::DICT_5X5_50},   {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
      {"DICT_5X5_250", cv::aruco::DICT_5X5_250}, {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
      {"DICT_6X6_50", cv::aruco::DICT_6X6_50},   {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
      {"DICT_6X6_250", cv::aruco::DICT_6X6_250}, {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
  };
  const auto found = known.find(name);
  vn::demand(found != known.end(), "the dictionary '", name, "' is not known; there are DICT_4X4_50 to DICT_6X6_1000");
  return found->second;
}

/// Corners of a ChArUco board, to a pixel.
void find_charuco(const vn::Board& board, const cv::Mat& grey, std::vector<cv::Point2f>& corners,
                  std::vector<int>& numbers) {
  const int columns = static_cast<int>(board.columns), rows = static_cast<int>(board.rows);
  const auto square = static_cast<float>(board.square), marker = static_cast<float>(board.marker);
#if VERNIER_NEW_ARUCO
  cv::aruco::CharucoBoard charuco({columns, rows}, square, marker,
                                  cv::aruco::getPredefinedDictionary(dictionary_number(board.dictionary)));
  charuco.setLegacyPattern(board.legacy_pattern);
  cv::aruco::CharucoDetector(charuco).detectBoard(grey, corners, numbers);
#else
  vn::demand(!board.legacy_pattern || rows % 2 == 1,
             "a board of an even number of rows with legacy_pattern needs OpenCV 4.7 or later");
  const auto dictionary = cv::aruco::getPredefinedDictionary(
      static_cast<cv::aruco::PREDEFINED_DICTIONARY_NAME>(dictionary_number(board.dictionary)));
  const auto charuco = cv::aruco::CharucoBoard::create(columns, rows, square, marker, dictionary);
  std::vector<std::vector<cv::Point2f>> markers;
  std::vector<int> of_markers;
  cv::aruco::detectMarkers(grey, dictionary, markers, of_markers);
  if (of_markers.empty()) return;
  cv::aruco::interpolateCornersCharuco(markers, of_markers, grey, charuco, corners, numbers);
  for (cv::Point2f& corner : corners) corner -= cv::Point2f(0.5F, 0.5F);  // these count from the corner of the pixel
#endif
}

/// Mean grey value around a pixel; negative outside of the image.
double brightness(const cv::Mat& grey, const cv::Point2d& at, int reach) {
  const cv::Rect box(static_cast<int>(std::lround(at.x)) - reach, static_cast<int>(std::lround(at.y)) - reach,
                     2 * reach + 1, 2 * reach + 1);
  const cv::Rect inside = box & cv::Rect(0, 0, grey.cols, grey.rows);
  return inside.area() == 0 ? -1 : cv::mean(grey(inside))[0];
}

/// All corners of a chessboard, to a pixel, from the end whose outer square is black.
void find_chessboard(const vn::Board& board, const cv::Mat& grey, std::vector<cv::Point2f>& corners,
                     std::vector<int>& numbers) {
  const cv::Size size(static_cast<int>(board.columns - 1), static_cast<int>(board.rows - 1));
  if (!cv::findChessboardCorners(grey, size, corners, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
    return;
  // the square before the first corner and the one beside it, both among the inner ones next to that corner
  const cv::Point2d first = corners[0], right = corners[1], down = corners[static_cast<std::size_t>(size.width)];
  const cv::Point2d inner = 0.5 * (right + down), beside = inner - (right - first);
  const int reach = std::max(1, static_cast<int>(cv::norm(right - first) / 6));
  const double of_inner = brightness(grey, inner, reach), of_beside = brightness(grey, beside, reach);
  // a square on the diagonal is black as the first one is
  if (of_inner > of_beside) std::reverse(corners.begin(), corners.end());
  // rows of a view from behind do not exist: a mirrored order is another reading direction of the same rows
  for (int k = 0; k < size.area(); ++k) numbers.push_back(k);
}

/// Smallest distance from each corner to another one [px].
std::vector<double> spacings(const std::vector<cv::Point2f>& corners) {
  std::vector<double> out(corners.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t k = 0; k < corners.size(); ++k)
      if (k != i) out[i] = std::min(out[i], cv::norm(corners[i] - corners[k]));
  return out;
}

vn::View detected(const vn::Board& board, const cv::Mat& grey) {
  vn::demand(board.marker > 0 || (board.rows + board.columns) % 2 == 1, "a chessboard of ", board.rows, " x ",
             board.columns, " squares looks the same after half a turn; take one row more or less, or markers");
  std::vector<cv::Point2f> corners;
  std::vector<int> numbers;
  if (board.marker > 0)
    find_charuco(board, grey, corners, numbers);
  else
    find_chessboard(board, grey, corners, numbers);
  vn::View out;
  out.width = grey.cols;
  out.height = grey.rows;
  // windows end before the next edge: of a square, or of a marker
  const double free = board.marker > 0 ? (board.square - board.marker) / (2 * board.square) : 0.5;
  const std::vector<double> spacing = spacings(corners);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int window = std::clamp(static_cast<int>(0.9 * free * spacing[i]), 2, 12);
    std::vector<cv::Point2f> one{corners[i]};
    cv::cornerSubPix(grey, one, {window, window}, {-1, -1},
                     {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-4});
    if (cv::norm(one[0] - corners[i]) > std::max(2.0, 0.2 * spacing[i])) continue;  // it went elsewhere
    out.corners.push_back(numbers[i]);
    out.pixels.emplace_back(one[0].x, one[0].y);
  }
  return out;
}

}  // namespace

vernier::View detect_board(const vernier::Board& board, const std::vector<unsigned char>& pixels, vernier::Index width,
                           vernier::Index height) {
  cv::Mat grey(static_cast<int>(height), static_cast<int>(width), CV_8UC1);
  vn::demand(pixels.size() == grey.total(), "detect_board: ", pixels.size(), " pixels for an image of ", width, " x ",
             height);
  std::copy(pixels.begin(), pixels.end(), grey.begin<unsigned char>());
  return detected(board, grey);
}

vernier::View detect_board(const vernier::Board& board, const std::string& file) {
  const cv::Mat grey = cv::imread(file, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) throw std::runtime_error(file + ": cannot be read as an image");
  vn::View out = detected(board, grey);
  out.image = std::filesystem::path(file).filename().string();
  return out;
}

std::vector<std::string> files_of(const std::string& pattern) {
  if (pattern.find('*') == std::string::npos) return {pattern};
  std::vector<cv::String> found;
  cv::glob(pattern, found, false);
  std::sort(found.begin(), found.end());
  return {found.begin(), found.end()};
}

std::vector<unsigned char> drawn_by_opencv(const vernier::Board& board, int pixels_per_square) {
  const int columns = static_cast<int>(board.columns), rows = static_cast<int>(board.rows);
  const auto square = static_cast<float>(board.square), marker = static_cast<float>(board.marker);
  cv::Mat out;
  const cv::Size size(columns * pixels_per_square, rows * pixels_per_square);
#if VERNIER_NEW_ARUCO
  cv::aruco::CharucoBoard({columns, rows}, square, marker,
                          cv::aruco::getPredefinedDictionary(dictionary_number(board.dictionary)))
      .generateImage(size, out, 0, 1);
#else
  cv::aruco::CharucoBoard::create(columns, rows, square, marker,
                                  cv::aruco::getPredefinedDictionary(static_cast<cv::aruco::PREDEFINED_DICTIONARY_NAME>(
                                      dictionary_number(board.dictionary))))
      ->draw(size, out, 0, 1);
#endif
  return {out.begin<unsigned char>(), out.end<unsigned char>()};
}

}  // namespace support
