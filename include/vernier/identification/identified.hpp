#pragma once

/// @file
/// The outcome of an identification: the model, and how well it is known, in numbers and in words.

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "vernier/identification/calibrated.hpp"
#include "vernier/identification/observability.hpp"

namespace vernier {

/// How an identification ended.
enum class IdentifyStatus {
  converged,        ///< the model is the best the data support
  underdetermined,  ///< too few or too uniform measurements: the answer is one of many
  not_converged,    ///< the solver stopped before it was done
};

/// What became of one parameter.
enum class ParameterState {
  fixed,            ///< not asked for; its value is unchanged bit for bit
  identified,       ///< determined by the data
  weak,             ///< hardly determined: kept near nominal by a prior of physical size
  not_identifiable  ///< cannot be told apart from others, or has no effect on what was measured; its value is unchanged
};

/// One parameter of the arm, its frames included.
struct ParameterEstimate {
  /// Its name.
  std::string name;
  ParameterKind kind;  ///< length [m] or angle [rad]
  double nominal;      ///< value at the start
  double identified;   ///< value now
  double std;          ///< standard deviation; 0 for a parameter that did not move
  /// What became of it.
  ParameterState state;
  std::string remark;  ///< why it was not identified, in words; else empty
  double size = 0;     ///< expected size of its error
  /// Standard deviation of the prior that holds it near nominal; infinite where there is none.
  double prior = std::numeric_limits<double>::infinity();
};

/// An identified arm.
template <KinematicModel Model>
struct Identified {
  Calibrated<Model> model;  ///< usable as any kinematic model
  /// How it ended.
  IdentifyStatus status;
  std::string message;                        ///< why it ended, in words
  double rms_before = 0;                      ///< position error with frames registered and links nominal [m]
  double rms_after = 0;                       ///< position error now [m]
  double rotation_rms_after = 0;              ///< orientation error now [rad]; 0 for positions alone
  std::vector<ParameterEstimate> parameters;  ///< base, chain, tool: all of them
  std::vector<Index> free;                    ///< which of them were moved, in the order of `covariance`
  MatrixX covariance;                         ///< of the moved parameters [m, rad]; empty where the rank is deficient
  Index rank = 0;                             ///< of the moved parameters
  double condition = 0;           ///< of the Jacobian in steps of expected sizes; above 100 poses are poorly chosen
  int iterations = 0;             ///< of the solver, all rounds
  Observability observability{};  ///< of the moved parameters

  /// Whether the model may be trusted.
  bool converged() const { return status == IdentifyStatus::converged; }

  /// Names of the parameters in a state.
  std::vector<std::string> names(ParameterState state) const {
    std::vector<std::string> out;
    for (const auto& p : parameters)
      if (p.state == state) out.push_back(p.name);
    return out;
  }

  /// Pairs of moved parameters that the poses hardly tell apart, by name, strongest first: "d4 and tool_z (+0.98)".
  std::vector<std::string> strongly_correlated(double limit = 0.95) const {
    std::vector<std::string> out;
    for (const Correlation& c : strong_correlations(covariance, limit)) {
      char value[16];
      std::snprintf(value, sizeof value, "%+.2f", c.value);
      const auto name = [&](Index k) {
        return parameters[static_cast<std::size_t>(free[static_cast<std::size_t>(k)])].name;
      };
      out.push_back(name(c.first) + " and " + name(c.second) + " (" + value + ")");
    }
    return out;
  }

  /// The outcome in plain words, a few lines.
  std::string summary() const {
    const auto number = [](double value, int digits) {
      char buffer[48];
      std::snprintf(buffer, sizeof buffer, "%.*f", digits, value);
      return std::string(buffer);
    };
    const auto joined = [](const std::vector<std::string>& names) {
      std::string out;
      for (const auto& name : names) out += (out.empty() ? "" : ", ") + name;
      return out;
    };
    std::string out = (converged()                                 ? "Converged: "
                       : status == IdentifyStatus::underdetermined ? "UNDERDETERMINED: "
                                                                   : "NOT CONVERGED: ") +
                      message + "\n";
    out += "Position error (rms): " + number(rms_before * 1e3, 4) + " mm with frames registered and links nominal, " +
           number(rms_after * 1e3, 4) + " mm now.\n";
    if (rotation_rms_after > 0)
      out += "Orientation error (rms): " + number(rotation_rms_after * 1e3, 3) + " mrad now.\n";
    out += "Parameters moved: " + std::to_string(free.size()) + ", rank " + std::to_string(rank) + ", condition " +
           (std::isfinite(condition) ? number(condition, 0) : std::string("infinite")) + ".\n";
    std::vector<std::string> freed, held;  // beta moves only where d had to give way
    for (const auto& p : parameters)
      if (p.name.starts_with("beta") && p.state != ParameterState::fixed) {
        freed.push_back(p.name);
        held.push_back("d" + p.name.substr(4));
      }
    if (!freed.empty())
      out +=
          "Neighbouring axes nearly parallel: " + joined(freed) + " (Hayati) moved in place of " + joined(held) + ".\n";
    if (const auto weak = names(ParameterState::weak); !weak.empty())
      out += "Weakly determined, held near nominal by a prior: " + joined(weak) + ".\n";
    if (const auto pairs = strongly_correlated(); !pairs.empty()) {
      out += "Hardly told apart: ";
      for (std::size_t k = 0; k < pairs.size() && k < 4; ++k) out += (k > 0 ? ", " : "") + pairs[k];
      out += pairs.size() > 4 ? ", and " + std::to_string(pairs.size() - 4) + " pairs more.\n" : ".\n";
    }
    for (const auto& p : parameters)
      if (p.state == ParameterState::not_identifiable) out += "Not identifiable: " + p.name + ", " + p.remark + ".\n";
    return out;
  }
};

}  // namespace vernier
