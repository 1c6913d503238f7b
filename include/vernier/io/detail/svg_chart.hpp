// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// @file
/// Charts as inline SVG, drawn without any other program: the same values, the same bits. Colours and fonts are those
/// of the page's classes.

#include <string>
#include <vector>

#include "vernier/core/api.hpp"

namespace vernier::detail {

/// How a series is drawn.
enum class ChartStyle {
  line,    ///< through (x, y)
  band,    ///< filled from `y` to `upper`
  sticks,  ///< from the lower end of the vertical axis to y
};

/// Points of a chart, and how they are drawn.
struct ChartSeries {
  std::string title{};                  ///< in the legend; empty for none
  std::vector<double> x{};              ///< abscissas
  std::vector<double> y{};              ///< ordinates; a value that is not finite interrupts a line
  std::vector<double> upper{};          ///< of a band
  ChartStyle style = ChartStyle::line;  ///< how it is drawn
  int colour = 0;                       ///< which of the page's colours, from 0
};

/// A text at a point of a chart.
struct ChartLabel {
  double x, y;       ///< where, in the units of the axes
  std::string text;  ///< above that point
};

/// A chart with two axes, which contain all series.
struct Chart {
  std::string title{};                ///< what it shows, for those who do not see it
  std::string x_label{};              ///< quantity and unit
  std::string y_label{};              ///< quantity and unit
  bool log_x = false;                 ///< logarithmic; values that are not positive are left out
  bool log_y = false;                 ///< likewise
  std::vector<ChartSeries> series{};  ///< in the order of drawing
  std::vector<ChartLabel> labels{};   ///< over them
  int height = 280;                   ///< of a width of 640
};

/// The chart as an `svg` element; empty where no value can be drawn.
VERNIER_API std::string chart_svg(const Chart& chart);

/// Round values from `lower` to `upper`, about `count` of them; on a logarithmic axis decades, or 1, 2 and 5 of each.
VERNIER_API std::vector<double> chart_ticks(double lower, double upper, bool logarithmic, int count);

}  // namespace vernier::detail

#if VERNIER_HEADER_ONLY
#include "vernier/io/detail/svg_chart.ipp"
#endif
