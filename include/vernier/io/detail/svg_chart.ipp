// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/core/check.hpp"
#include "vernier/core/detail/number_text.hpp"
#include "vernier/core/same_value.hpp"
#include "vernier/io/detail/html.hpp"
#include "vernier/io/detail/svg_chart.hpp"

namespace vernier::detail {

VERNIER_IMPL std::vector<double> chart_ticks(double lower, double upper, bool logarithmic, int count) {
  std::vector<double> out;
  if (!(upper > lower)) return out;
  if (logarithmic) {
    const double decades = std::log10(upper / lower);
    for (int power = static_cast<int>(std::floor(std::log10(lower))); power <= std::ceil(std::log10(upper)); ++power)
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double tick = digit * std::pow(10, power);
        if ((digit < 2 || decades < 2) && tick >= lower * (1 - 1e-9) && tick <= upper * (1 + 1e-9)) out.push_back(tick);
      }
    return out;
  }
  const double rough = (upper - lower) / count, power = std::pow(10, std::floor(std::log10(rough)));
  const double step = power * (rough < 1.5 * power ? 1 : rough < 3.5 * power ? 2 : rough < 7.5 * power ? 5 : 10);
  for (double k = std::ceil(lower / step - 1e-9); k * step <= upper + 1e-9 * step; ++k)
    out.push_back(same_value(k, 0) ? 0 : k * step);
  return out;
}

/// An axis: what its values are in pixels.
struct ChartScale {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  bool logarithmic = false;
  double from = 0, to = 1;

  bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
  void include(double value) {
    if (!shows(value)) return;
    lower = (std::min)(lower, value);
    upper = (std::max)(upper, value);
  }
  double operator()(double value) const {
    const double v = std::clamp(value, lower, upper);
    const double share = logarithmic ? std::log(v / lower) / std::log(upper / lower) : (v - lower) / (upper - lower);
    return from + share * (to - from);
  }
};

/// Makes room around the values of an axis.
VERNIER_LOCAL void widen_scale(ChartScale& scale, double margin) {
  if (scale.logarithmic) {
    const double factor = scale.upper > scale.lower ? std::pow(scale.upper / scale.lower, margin) : 2;
    scale.lower /= factor;
    scale.upper *= factor;
  } else {
    const double width = scale.upper - scale.lower,
                 by = width > 0 ? margin * width : (std::max)(1.0, std::abs(scale.upper));
    scale.lower -= by;
    scale.upper += by;
  }
}

/// The path of one series; a class gives it colour.
VERNIER_LOCAL std::string series_path(const ChartSeries& series, const ChartScale& x, const ChartScale& y) {
  const std::size_t n = (std::min)(series.x.size(), series.y.size());
  const auto point = [&](double a, double b) { return tenths(x(a)) + ' ' + tenths(y(b)); };
  std::string path;
  const auto shown = [&](std::size_t i) { return i < n && x.shows(series.x[i]) && y.shows(series.y[i]); };
  if (series.style == ChartStyle::sticks) {
    const std::string foot = 'V' + tenths(y.from);
    for (std::size_t i = 0; i < n; ++i)
      if (shown(i)) path += 'M' + point(series.x[i], series.y[i]) + foot;
  } else {
    const bool band = series.style == ChartStyle::band;
    for (std::size_t i = 0; i < n; ++i) {
      if (!shown(i)) continue;
      const std::size_t begin = i;
      path += 'M' + point(series.x[i], series.y[i]);
      for (++i; shown(i); ++i) path += (i == begin + 1 ? "L" : " ") + point(series.x[i], series.y[i]);
      if (!band) continue;
      for (std::size_t k = i; k-- > begin;) path += (k + 1 == i ? "L" : " ") + point(series.x[k], series.upper[k]);
      path += 'Z';
    }
  }
  static constexpr const char* styles[] = {"line", "band", "sticks"};
  return path.empty() ? ""
                      : message("<path class=\"", styles[static_cast<int>(series.style)], " c", series.colour,
                                "\" d=\"", path, "\"/>\n");
}

VERNIER_IMPL std::string chart_svg(const Chart& chart) {
  constexpr double width = 640, left = 62, right = 14, top = 24, bottom = 44;
  ChartScale x{.logarithmic = chart.log_x}, y{.logarithmic = chart.log_y};
  for (const ChartSeries& series : chart.series) {
    for (const double value : series.x) x.include(value);
    for (const double value : series.y) y.include(value);
    for (const double value : series.upper) y.include(value);
    if (series.style == ChartStyle::sticks && !chart.log_y) y.include(0);
  }
  if (!(x.upper >= x.lower) || !(y.upper >= y.lower)) return "";
  widen_scale(x, x.upper > x.lower ? 0 : 1);
  widen_scale(y, 0.05);
  x.from = left;
  x.to = width - right;
  y.from = chart.height - bottom;
  y.to = top;
  std::string out = message("<svg class=\"chart\" viewBox=\"0 0 640 ", chart.height, "\" role=\"img\" aria-label=\"",
                            html_escape(chart.title), "\">\n");
  std::string grid, texts;
  for (const double tick : chart_ticks(x.lower, x.upper, chart.log_x, 8)) {
    grid += 'M' + tenths(x(tick)) + ' ' + tenths(y.from) + 'V' + tenths(y.to);
    texts += "<text class=\"tick mid\" x=\"" + tenths(x(tick)) + "\" y=\"" + tenths(y.from + 16) + "\">" +
             significant_digits(tick, 6) + "</text>\n";
  }
  for (const double tick : chart_ticks(y.lower, y.upper, chart.log_y, 5)) {
    grid += 'M' + tenths(x.from) + ' ' + tenths(y(tick)) + 'H' + tenths(x.to);
    texts += "<text class=\"tick end\" x=\"" + tenths(x.from - 6) + "\" y=\"" + tenths(y(tick) + 4) + "\">" +
             significant_digits(tick, 6) + "</text>\n";
  }
  out += "<path class=\"grid\" d=\"" + grid + "\"/>\n" + texts;
  for (const ChartSeries& series : chart.series) out += series_path(series, x, y);
  double at = left;
  for (const ChartSeries& series : chart.series) {
    if (series.title.empty()) continue;
    out +=
        message("<path class=\"key c", series.colour, "\" d=\"M", tenths(at), " 12h18\"/>\n<text class=\"tick\" x=\"",
                tenths(at + 23), "\" y=\"16\">", html_escape(series.title), "</text>\n");
    at += 40 + 6.4 * static_cast<double>(series.title.size());
  }
  for (const ChartLabel& label : chart.labels)
    if (x.shows(label.x) && y.shows(label.y))
      out += message("<text class=\"tick ", x(label.x) > 440 ? "end" : "", "\" x=\"",
                     tenths(x(label.x) + (x(label.x) > 440 ? -4 : 4)), "\" y=\"",
                     tenths((std::max)(y(label.y) - 3, top + 9)), "\">", html_escape(label.text), "</text>\n");
  out += message("<text class=\"tick mid\" x=\"", tenths((x.from + x.to) / 2), "\" y=\"", chart.height - 8, "\">",
                 html_escape(chart.x_label), "</text>\n<text class=\"tick mid\" transform=\"translate(14 ",
                 tenths((y.from + y.to) / 2), ") rotate(-90)\">", html_escape(chart.y_label), "</text>\n</svg>\n");
  return out;
}

}  // namespace vernier::detail
