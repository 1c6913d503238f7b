// SPDX-License-Identifier: BSD-3-Clause
#include "figures.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>

#include "vernier/core/atomic_file.hpp"
#include "vernier/core/check.hpp"

namespace support {

namespace {

constexpr std::array<const char*, palette_size> palette{"#000000", "#E69F00", "#56B4E9", "#009E73",
                                                        "#D55E00", "#0072B2", "#CC79A7"};

/// Dashes and shapes of points by colour, so that neighbours in grey differ: dark solid lines beside light dashed ones.
constexpr std::array<int, palette_size> dashes{1, 1, 2, 5, 4, 1, 3};
constexpr std::array<int, palette_size> shapes{7, 5, 6, 9, 8, 7, 4};

std::size_t index_of(const Series& series, std::size_t position) {
  return (series.colour < 0 ? position : static_cast<std::size_t>(series.colour)) % palette.size();
}

const char* colour(const Series& series, std::size_t position) { return palette[index_of(series, position)]; }

constexpr int font_size = 18;  ///< of all letters, so that figures can be read at half their width

/// A gnuplot string.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : c == '\n' ? " " : std::string(1, c);
  return out + "'";
}

std::string range(const char* axis, const std::optional<std::pair<double, double>>& limits) {
  return limits ? fmt::format("set {}range [{}:{}]\n", axis, limits->first, limits->second) : std::string();
}

/// What all figures share: a white page, a quiet grid behind the data, the legend below and never over them.
std::string preamble(const std::string& title, const std::string& y_label, const FigureOptions& options) {
  std::string out = fmt::format(
      "set terminal svg noenhanced size {},{} dynamic background rgb 'white' font 'sans-serif,{}' linewidth 1.4\n"
      "set encoding utf8\n"
      "set title {} offset 0,-0.3\n"
      "set ylabel {} offset -0.5,0\n"
      "set border 3 linecolor rgb '#444444'\n"
      "set tics nomirror out scale 0.6,0.3 textcolor rgb '#222222'\n"
      "set grid back xtics ytics linetype 1 linewidth 0.5 linecolor rgb '#dddddd'\n"
      "set key below center horizontal Left reverse samplen 2.2 spacing 1.2 height 0.4 textcolor rgb '#222222'\n"
      "set rmargin 3\n",
      options.width, options.height, font_size, quoted(title), quoted(y_label));
  return out;
}

/// A logarithmic axis that fits the data; where it spans few decades, with more ticks than one a decade.
/// @param labelled whether ticks have numbers
template <class Select>
std::string log_axis(const char* axis, const std::vector<Series>& series,
                     const std::optional<std::pair<double, double>>& limits, Select&& select, bool labelled = true) {
  double lower = std::numeric_limits<double>::infinity(), upper = 0;
  for (const Series& s : series)
    for (const double value : select(s))
      if (std::isfinite(value) && value > 0) {
        lower = std::min(lower, value);
        upper = std::max(upper, value);
      }
  std::string out = fmt::format("set logscale {0}\nset format {0} '{1}'\n", axis, labelled ? "%g" : "");
  if (!(upper > 0)) return out;
  const std::pair<double, double> ends = limits.value_or(std::pair{lower / 1.15, upper * 1.15});
  out += range(axis, ends);
  if (ends.second / ends.first > 1000) return out;
  const std::vector<int> marks =
      ends.second / ends.first > 8 ? std::vector<int>{1, 2, 5} : std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9};
  std::string ticks;
  for (double decade = std::pow(10, std::floor(std::log10(ends.first))); decade <= ends.second; decade *= 10)
    for (const int mark : marks)
      if (const double tick = mark * decade; tick >= ends.first && tick <= ends.second)
        ticks += fmt::format("{}'{}' {:g}", ticks.empty() ? "" : ", ", labelled ? fmt::format("{:g}", tick) : "", tick);
  return ticks.empty() ? out : out + fmt::format("set {}tics ({})\n", axis, ticks);
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// All that was written to a file.
std::string content_of(std::FILE* file) {
  std::string out;
  std::rewind(file);
  char buffer[1 << 14];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) out.append(buffer, n);
  return out;
}

/// Runs gnuplot with its standard streams on files: no shell, no quoting of paths, nothing half-written.
bool draw(const std::filesystem::path& path, const std::string& script) {
  static bool missing = false;
  if (missing) return false;
  const auto fail = [&](const std::string& why) -> void {
    throw std::runtime_error(path.string() + ": the figure cannot be drawn: " + why);
  };
  const File input(std::tmpfile()), output(std::tmpfile()), errors(std::tmpfile());
  if (!input || !output || !errors) fail(std::strerror(errno));
  if (std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() || std::fflush(input.get()) != 0)
    fail(std::strerror(errno));
  std::rewind(input.get());

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(output.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(errors.get()), STDERR_FILENO);
  std::string program = "gnuplot", no_start_files = "-d", from_stdin = "-";
  char* const arguments[] = {program.data(), no_start_files.data(), from_stdin.data(), nullptr};
  pid_t child = 0;
  const int spawned = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (spawned == 0)
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (spawned == ENOENT || (spawned == 0 && WIFEXITED(status) && WEXITSTATUS(status) == 127)) {
    missing = true;
    static_cast<void>(std::fputs("gnuplot is not installed: going on without figures\n", stderr));
    return false;
  }
  if (spawned != 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string words = content_of(errors.get()).substr(0, 400);
    std::replace(words.begin(), words.end(), '\n', ' ');
    fail(spawned != 0 ? std::strerror(spawned) : "gnuplot says: " + words);
  }
  const std::string figure = content_of(output.get());
  if (figure.find("</svg>") == std::string::npos) fail("gnuplot wrote a part of it");
  vernier::write_file(path.string(), figure);
  return true;
}

}  // namespace

namespace {

/// How gnuplot is told to draw a series.
std::string look_of(const Series& s, std::size_t position) {
  const std::size_t k = index_of(s, position);
  const char* c = palette[k];
  const int dash = s.colour < 0 && position >= palette.size() ? 5 - dashes[k] : dashes[k];
  switch (s.style) {
    case Style::lines: return fmt::format("with lines linewidth 2 dashtype {} linecolor rgb '{}'", dash, c);
    case Style::dashed: return fmt::format("with lines dashtype 2 linewidth 1.6 linecolor rgb '{}'", c);
    case Style::points: return fmt::format("with points pointtype {} pointsize 0.42 linecolor rgb '{}'", shapes[k], c);
    case Style::steps: return fmt::format("with steps linewidth 2 dashtype {} linecolor rgb '{}'", dash, c);
    case Style::filled_steps:
      return fmt::format("with fillsteps fillstyle transparent solid 0.25 noborder linecolor rgb '{}'", c);
  }
  return {};
}

/// The sample of a series in a legend.
std::string legend_of(const Series& s, std::size_t position) {
  const std::size_t k = index_of(s, position);
  if (s.style != Style::points) return fmt::format("NaN {} title {}", look_of(s, position), quoted(s.name));
  // a dot that is right among hundreds is too small for a legend
  return fmt::format("NaN with points pointtype {} pointsize 0.9 linecolor rgb '{}' title {}", shapes[k], palette[k],
                     quoted(s.name));
}

/// A number of a figure, to six digits.
std::string figure_number(double value) { return fmt::format("{:.6g}", value); }

/// Writes the data of series to a script.
/// @param first number of the first block of data
/// @return the plots of those that have something to draw, without legend
std::string plots_of(const std::vector<Series>& series, const FigureOptions& options, std::size_t first,
                     std::string& script) {
  std::string plots;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const Series& s = series[k];
    vernier::demand(s.x.size() == s.y.size(), "plot_svg: series '", s.name, "' has ", s.x.size(), " x and ", s.y.size(),
                    " y");
    fmt::format_to(std::back_inserter(script), "$data{} << EOD\n", first + k);
    bool any = false;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const bool drawn = std::isfinite(s.x[i]) && std::isfinite(s.y[i]) && (!options.log_x || s.x[i] > 0) &&
                         (!options.log_y || s.y[i] > 0);
      if (drawn) fmt::format_to(std::back_inserter(script), "{} {}\n", figure_number(s.x[i]), figure_number(s.y[i]));
      if (!drawn) script += "\n";
      any = any || drawn;
    }
    script += "EOD\n";
    if (any)
      fmt::format_to(std::back_inserter(plots), "{}$data{} using 1:2 {} notitle", plots.empty() ? "" : ", ", first + k,
                     look_of(s, k));
  }
  return plots;
}

/// The distance of ticks: a round number that leaves 90 pixels between them.
double step_of(double range, double pixels) {
  const double least = range / std::max(2.0, pixels / 90);
  const double decade = std::pow(10, std::floor(std::log10(least)));
  for (const double mark : {1.0, 2.0, 5.0})
    if (mark * decade >= least) return mark * decade;
  return 10 * decade;
}

/// The axes of a plot.
/// @param numbers_at_x, numbers_at_y whether their ticks have numbers
std::string axes_of(const std::vector<Series>& series, const FigureOptions& options, bool numbers_at_x = true,
                    bool numbers_at_y = true) {
  const auto linear = [](const char* axis, const auto& limits, bool numbers) {
    return fmt::format("set format {} '{}'\n", axis, numbers ? "%g" : "") + range(axis, limits);
  };
  return (options.log_x ? log_axis(
                              "x", series, options.x_range, [](const Series& s) { return s.x; }, numbers_at_x)
                        : linear("x", options.x_range, numbers_at_x)) +
         (options.log_y ? log_axis(
                              "y", series, options.y_range, [](const Series& s) { return s.y; }, numbers_at_y)
                        : linear("y", options.y_range, numbers_at_y));
}

}  // namespace

bool plot_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
              const std::string& y_label, const std::vector<Series>& series, const FigureOptions& options) {
  FigureOptions page = options;
  std::string key;
  if (series.size() > palette.size()) {  // too many for a legend below; in a lower page they would get two columns
    page.height = std::max(page.height, 180 + 33 * static_cast<int>(series.size()));
    std::size_t longest = 0;
    for (const Series& one : series) longest = std::max(longest, one.name.size());
    page.width += 80 + 10 * static_cast<int>(longest);
    key = fmt::format("set key outside right top vertical maxcols 1 maxrows 0\nset rmargin {}\n", 10 + longest);
  }
  std::string script = preamble(title, y_label, page) + key;
  script += fmt::format("set xlabel {} offset 0,0.4\n", quoted(x_label)) + axes_of(series, options);
  if (options.equal_axes) script += "set size ratio -1\n";
  std::string plots = plots_of(series, options, 0, script);
  vernier::demand(!plots.empty(), "plot_svg: nothing to draw in ", path.string());
  for (std::size_t k = 0; k < series.size(); ++k)
    if (!series[k].name.empty()) plots += ", " + legend_of(series[k], k);
  return draw(path, script + "plot " + plots + "\n");
}

bool panels_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
                const std::string& y_label, const std::vector<Panel>& panels, const FigureOptions& options) {
  vernier::demand(!panels.empty(), "panels_svg: nothing to draw in ", path.string());
  const auto count = static_cast<int>(panels.size());
  const bool own = std::any_of(panels.begin(), panels.end(), [](const Panel& p) { return !p.y_label.empty(); });
  const int columns = own ? 1 : std::min(count, count == 4 ? 2 : 3), rows = (count + columns - 1) / columns;
  std::vector<Series> all, named;
  for (const Panel& panel : panels)
    for (const Series& s : panel.series) {
      all.push_back(s);
      const bool known = std::any_of(named.begin(), named.end(), [&](const Series& n) { return n.name == s.name; });
      if (!s.name.empty() && !known) named.push_back(s);
    }
  FigureOptions page = options;
  std::size_t longest = 0;
  for (const Series& s : named) longest = std::max(longest, s.name.size());
  const int entries = static_cast<int>(named.size()),
            across = std::clamp(page.width / (80 + 10 * static_cast<int>(longest)), 1, std::max(entries, 1)),
            legend_rows = (entries + across - 1) / across;
  const int legend = 34 * legend_rows, head = 64, foot = 84;
  const int left = 92, inside = own ? 210 : columns == 1 ? 360 : 250;
  page.height = head + foot + legend + rows * inside;
  // one place for the axes of each plot, in shares of the page
  const double left_share = static_cast<double>(left) / page.width, right_share = 1 - 18.0 / page.width;
  const double top_share = 1 - static_cast<double>(head) / page.height,
               bottom_share = static_cast<double>(foot + legend) / page.height;
  const double gap_x = 14.0 / page.width, gap_y = 40.0 / page.height;
  const double wide = (right_share - left_share - (columns - 1) * gap_x) / columns,
               high = (top_share - bottom_share - (rows - 1) * gap_y) / rows;
  std::string script = preamble("", "", page);
  script += fmt::format("set multiplot\nunset key\nset label 1 {} at screen 0.5,{:.4f} center\n", quoted(title),
                        1 - 18.0 / page.height);
  if (!own)
    script += fmt::format("set label 2 {} at screen {:.4f},{:.4f} center rotate by 90\n", quoted(y_label),
                          16.0 / page.width, 0.5 * (top_share + bottom_share));
  script += fmt::format("set label 3 {} at screen {:.4f},{:.4f} center\n", quoted(x_label),
                        0.5 * (left_share + right_share), static_cast<double>(legend + 20) / page.height);
  const auto extent = [&](const auto& values_of) -> std::optional<std::pair<double, double>> {
    double low = std::numeric_limits<double>::infinity(), high_end = -low;
    for (const Series& s : all)
      for (const double value : values_of(s))
        if (std::isfinite(value)) {
          low = std::min(low, value);
          high_end = std::max(high_end, value);
        }
    if (!(high_end > low)) return {};
    const double margin = 0.03 * (high_end - low);
    return std::pair{low - margin, high_end + margin};
  };
  if (!page.x_range && !page.log_x) page.x_range = extent([](const Series& s) { return s.x; });
  if (!own && !page.y_range && !page.log_y) page.y_range = extent([](const Series& s) { return s.y; });
  if (options.equal_axes && page.x_range && page.y_range) {  // the ranges fill the panels at one scale
    auto& [x0, x1] = *page.x_range;
    auto& [y0, y1] = *page.y_range;
    const double across_px = wide * page.width, up_px = high * page.height;
    const double scale = std::max((x1 - x0) / across_px, (y1 - y0) / up_px);
    const double mid_x = 0.5 * (x0 + x1), mid_y = 0.5 * (y0 + y1);
    page.x_range = {mid_x - 0.5 * scale * across_px, mid_x + 0.5 * scale * across_px};
    page.y_range = {mid_y - 0.5 * scale * up_px, mid_y + 0.5 * scale * up_px};
  }
  if (page.x_range)  // few enough ticks for numbers that do not touch
    script += fmt::format("set xtics {:g}\n", step_of(page.x_range->second - page.x_range->first, wide * page.width));
  std::size_t first = 0;
  for (int k = 0; k < count; ++k) {
    const Panel& panel = panels[static_cast<std::size_t>(k)];
    const int row = k / columns, column = k % columns;
    const double x0 = left_share + column * (wide + gap_x), y1 = top_share - row * (high + gap_y);
    script += fmt::format(
        "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n"
        "set bmargin at screen {:.4f}\nset title {} offset 0,-0.6\n",
        x0, x0 + wide, y1, y1 - high, quoted(panel.title));
    // numbers of the ticks stand at the left and under the last plot of a column
    script += axes_of(own ? panel.series : all, page, k + columns >= count, column == 0);
    if (own) script += fmt::format("set ylabel {} offset -0.5,0\n", quoted(panel.y_label));
    const std::string plots = plots_of(panel.series, options, first, script);
    first += panel.series.size();
    vernier::demand(!plots.empty(), "panels_svg: nothing to draw in '", panel.title, "'");
    script += "plot " + plots + "\nunset label\n";
  }
  if (!named.empty()) {  // a plot without anything but its legend
    script +=
        "set lmargin at screen 0\nset rmargin at screen 1\nset tmargin at screen 1\nset bmargin at screen 0\n"
        "unset logscale\nunset border\nunset tics\nunset xlabel\nunset ylabel\nset title ''\n"
        "unset grid\n";
    script += fmt::format(
        "set key at screen 0.5,0.01 bottom center vertical maxrows {} Left reverse samplen 2.2 spacing 1.2\n"
        "plot [0:1] [0:1] ",
        legend_rows);
    for (std::size_t k = 0; k < named.size(); ++k) script += (k > 0 ? ", " : "") + legend_of(named[k], k);
    script += "\n";
  }
  return draw(path, script + "unset multiplot\n");
}

bool intervals_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
                   const std::vector<Interval>& intervals) {
  vernier::demand(!intervals.empty(), "intervals_svg: nothing to draw in ", path.string());
  std::string script = preamble(title, "", {.height = 130 + 30 * static_cast<int>(intervals.size())}), data, ticks;
  double row = 0;
  for (const Interval& i : intervals) {
    row -= 1;
    ticks += fmt::format("{}{} {}", ticks.empty() ? "" : ", ", quoted(i.name), row);
    if (std::isfinite(i.centre) && std::isfinite(i.half_width))
      data += fmt::format("{} {} {}\n", i.centre, row, i.half_width);
  }
  script += fmt::format("set xlabel {} offset 0,0.4\nset yrange [{}:0]\nset ytics ({}) scale 0\nunset key\n",
                        quoted(x_label), row - 1, ticks);
  script += "$data << EOD\n" + data + "EOD\n";
  return draw(path,
              script + fmt::format("plot $data using 1:2:3 with xerrorbars pointtype 7 pointsize 0.9 linewidth 1.8 "
                                   "linecolor rgb '{}'\n",
                                   palette[5]));
}

bool dots_svg(const std::filesystem::path& path, const std::string& title, const std::string& x_label,
              const std::vector<std::string>& labels, const std::vector<Series>& series) {
  vernier::demand(!labels.empty() && !series.empty(), "dots_svg: nothing to draw in ", path.string());
  const auto rows = static_cast<int>(labels.size());
  std::string script = preamble(title, "", {.height = 150 + 34 * rows}), ticks, plots;
  for (int i = 0; i < rows; ++i)
    ticks += fmt::format("{}{} {}", i == 0 ? "" : ", ", quoted(labels[static_cast<std::size_t>(i)]), -i);
  script += fmt::format("set xlabel {} offset 0,0.4\nset yrange [{}:0.6]\nset ytics ({}) scale 0\n", quoted(x_label),
                        -rows + 0.4, ticks);
  double lower = std::numeric_limits<double>::infinity(), upper = 0;
  for (const Series& s : series)
    for (const double value : s.y)
      if (std::isfinite(value) && value > 0) {
        lower = std::min(lower, value);
        upper = std::max(upper, value);
      }
  // room for the values on the left
  script += log_axis("x", series, std::pair{lower * std::pow(lower / upper, 0.3), upper * 1.15},
                     [](const Series& s) { return s.y; });
  for (std::size_t k = 0; k < series.size(); ++k) {
    vernier::demand(series[k].y.size() == labels.size(), "dots_svg: series '", series[k].name, "' has ",
                    series[k].y.size(), " values for ", rows, " labels");
    fmt::format_to(std::back_inserter(script), "$data{} << EOD\n", k);
    for (int i = 0; i < rows; ++i)
      if (const double value = series[k].y[static_cast<std::size_t>(i)]; std::isfinite(value) && value > 0)
        fmt::format_to(std::back_inserter(script), "{} {} {:.3g}\n", value, -i, value);
    script += "EOD\n";
    fmt::format_to(std::back_inserter(plots),
                   "{}$data{} using 1:2 with points pointtype {} pointsize {} linecolor rgb '{}' title {}",
                   k == 0 ? "" : ", ", k, k == 0 ? 7 : 4, k == 0 ? 1.1 : 0.8, colour(series[k], k),
                   quoted(series[k].name));
    if (k == 0) plots += ", $data0 using 1:2:3 with labels right offset -1.2,0 notitle";
  }
  return draw(path, script + "plot " + plots + "\n");
}

std::vector<Series> histogram(const std::vector<Sample>& samples, int bins, bool log, std::optional<double> smallest) {
  vernier::demand(bins >= 1, "histogram: ", bins, " bins, must be at least 1");
  const auto counted = [&](double value) { return std::isfinite(value) && (!log || value > 0); };
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const Sample& sample : samples)
    for (const double value : sample.values)
      if (counted(value)) {
        lower = std::min(lower, value);
        upper = std::max(upper, value);
      }
  if (smallest) lower = *smallest;
  vernier::demand(std::isfinite(lower) && std::isfinite(upper) && (!log || lower > 0), "histogram: nothing to count");
  if (!(upper > lower)) upper = log ? lower * 1.1 : lower + 1;
  const auto scale = [&](double value) { return log ? std::log(value) : value; };
  const double width = (scale(upper) - scale(lower)) / bins;
  const auto edge = [&](int k) {
    const double at = scale(lower) + k * width;
    return log ? std::exp(at) : at;
  };
  std::vector<Series> out;
  for (const Sample& sample : samples) {
    std::vector<double> counts(static_cast<std::size_t>(bins), 0);
    for (const double value : sample.values)
      if (counted(value)) {
        const double at = std::clamp((scale(std::max(value, lower)) - scale(lower)) / width, 0.0, bins - 1.0);
        ++counts[static_cast<std::size_t>(at)];
      }
    Series series{sample.name, {}, {}, Style::steps, sample.colour};
    // gnuplot's steps go from a point horizontally to the next x, then vertically
    const double n = std::max<double>(1, static_cast<double>(sample.values.size()));
    for (int k = 0; k < bins; ++k) {
      series.x.push_back(edge(k));
      series.y.push_back(100 * counts[static_cast<std::size_t>(k)] / n);
    }
    series.x.push_back(edge(bins));
    series.y.push_back(0);
    out.push_back(std::move(series));
  }
  return out;
}

std::vector<Series> cumulative(const std::vector<Sample>& samples) {
  std::vector<Series> out;
  for (const Sample& sample : samples) {
    Series series{sample.name, sample.values, {}, Style::lines, sample.colour};
    std::erase_if(series.x, [](double value) { return !std::isfinite(value); });
    std::sort(series.x.begin(), series.x.end());
    for (std::size_t i = 0; i < series.x.size(); ++i)
      series.y.push_back(100 * static_cast<double>(i + 1) / static_cast<double>(series.x.size()));
    out.push_back(std::move(series));
  }
  return out;
}

}  // namespace support
