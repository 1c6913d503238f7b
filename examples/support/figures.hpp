// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Figures as SVG files, drawn by gnuplot.
///
/// Each function returns whether the figure is there. Where gnuplot is missing it prints a notice, once, on standard
/// error, and the program goes on without figures.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace support {

/// How a series is drawn.
enum class Style { lines, dashed, points, steps, filled_steps };

/// One curve or cloud of points.
struct Series {
  std::string name;  ///< in the legend; empty: not there
  std::vector<double> x;
  std::vector<double> y;  ///< as many as x; values that are not finite leave a gap
  Style style = Style::lines;
  int colour = -1;  ///< index into the palette; below 0: the position of the series
};

/// What is not data.
struct FigureOptions {
  bool log_x = false;
  bool log_y = false;
  std::optional<std::pair<double, double>> x_range{};
  std::optional<std::pair<double, double>> y_range{};
  int width = 760;          ///< [px]; half of it can still be read
  int height = 500;         ///< [px]
  bool equal_axes = false;  ///< one unit is as long on both axes
};

/// The palette has this many colours: those of Okabe and Ito, distinguishable by colour-blind readers too. 0 is black.
/// Each colour has a dash and a shape of points of its own, so figures can be read in grey. Series beyond them have the
/// colours again, with other dashes.
inline constexpr int palette_size = 7;

/// Draws series over x. Labels name the unit: "position error [mm]".
/// @throws std::invalid_argument when a series has not as many x as y
/// @throws std::runtime_error when the file cannot be written
bool plot_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
              const std::string& y_label, const std::vector<Series>& series, const FigureOptions& options = {});

/// One of several small plots beside each other.
struct Panel {
  std::string title;
  std::vector<Series> series;
  std::string y_label{};  ///< where its unit is another one than that of the others, which then have axes of their own
};

/// Draws small plots with the same axes beside each other, at most three in a row; series of one name have one entry
/// in a legend below.
/// @throws as `plot_svg`
bool panels_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
                const std::string& y_label, const std::vector<Panel>& panels, const FigureOptions& options = {});

/// A value and what surrounds it.
struct Interval {
  std::string name;
  double centre = 0;
  double half_width = 0;
};

/// Draws intervals below each other, the first one at the top.
/// @throws as `plot_svg`
bool intervals_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
                   const std::vector<Interval>& intervals);

/// Draws points below each other, one row a label, the first one at the top, on a logarithmic axis; the values of the
/// first series are written beside its points.
/// @param series y: one value a label; their x are not used
/// @throws as `plot_svg`
bool dots_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
              const std::vector<std::string>& labels, const std::vector<Series>& series);

/// Values of one kind, to be counted.
struct Sample {
  std::string name;
  std::vector<double> values;
  int colour = -1;  ///< as in `Series`
};

/// Histograms over bins that all samples share, as outlines; y is the share of a sample in a bin [%].
/// @param bins      number of bins, at least 1
/// @param log       bins of equal ratio instead of equal width; values at or below 0 are not counted
/// @param smallest  lower end of the first bin where given; smaller values count in the first bin
std::vector<Series> histogram(const std::vector<Sample>& samples, int bins, bool log = false,
                              std::optional<double> smallest = {});

/// Cumulative distributions: y is the share of values at or below x [%].
std::vector<Series> cumulative(const std::vector<Sample>& samples);

}  // namespace support
