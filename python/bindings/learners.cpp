// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <memory>

#include "arrays.hpp"
#include "bind.hpp"
#include "vernier/core/check.hpp"
#include "vernier/search/any_tuned.hpp"
#include "vernier/search/genetic_algorithm.hpp"
#include "vernier/search/pso.hpp"
#include "watch.hpp"

namespace python {

namespace {

namespace vn = vernier;

/// A fitted map; its predictions have one axis less where its targets had.
struct Predictor {
  std::shared_ptr<const vn::AnyPredictor> map;
  std::string learner;
  bool flat;
};

vn::InputMap input_map_of(const std::string& word) {
  if (word == "raw") return vn::InputMap::raw;
  if (word == "sines_and_cosines") return vn::InputMap::sines_and_cosines;
  vn::demand(word == "sine_cosine_products", "input_map: '", word,
             "' is none of raw, sines_and_cosines and sine_cosine_products");
  return vn::InputMap::sine_cosine_products;
}

vn::Activation activation_of(const std::string& word) {
  if (word == "sigmoid") return vn::Activation::sigmoid;
  if (word == "tanh") return vn::Activation::tanh;
  if (word == "sine") return vn::Activation::sine;
  vn::demand(word == "radial_basis", "activation: '", word, "' is none of sigmoid, tanh, sine and radial_basis");
  return vn::Activation::radial_basis;
}

/// Rows of numbers as a matrix; a vector is one column.
vn::MatrixX columns_of(const py::object& object, const char* name, bool& flat) {
  const Array array = numbers(object, name);
  vn::demand(array.ndim() == 1 || array.ndim() == 2, name, ": an array of shape (n,) or (n, columns) is expected");
  flat = array.ndim() == 1;
  vn::MatrixX out(array.shape(0), flat ? 1 : array.shape(1));
  const double* at = array.data();
  for (vn::Index i = 0; i < out.rows(); ++i)
    for (vn::Index k = 0; k < out.cols(); ++k) out(i, k) = *at++;
  return out;
}

/// The options of a recipe, by name; what is left over is misspelt.
class Options {
 public:
  explicit Options(py::dict options) : options_(std::move(options)) {}

  template <class T>
  void take(const char* name, T& value) {
    if (!options_.contains(name)) return;
    const py::object given = options_.attr("pop")(name);
    try {
      if (!given.is_none()) value = given.cast<T>();
    } catch (const py::cast_error&) {
      vn::demand(false, name, ": ", std::string(py::repr(given)), " cannot be used");
    }
  }
  template <class T>
  void take_word(const char* name, T& value, T (*meaning)(const std::string&)) {
    std::string word;
    take(name, word);
    if (!word.empty()) value = meaning(word);
  }
  /// @throws std::invalid_argument naming an option that was not taken
  void require_all_taken(const std::string& learner) const {
    for (const auto& item : options_)
      vn::demand(false, learner, ": has no option '", item.first.cast<std::string>(), "'");
  }

 private:
  py::dict options_;
};

template <class R>
R network_of(Options& options) {
  R out;
  options.take("hidden_nodes", out.hidden_nodes);
  options.take_word("activation", out.activation, activation_of);
  options.take_word("input_map", out.input_map, input_map_of);
  options.take("weight_limit", out.weight_limit);
  return out;
}

vn::VectorX vector_of_list(const std::vector<double>& values) {
  return Eigen::Map<const vn::VectorX>(values.data(), static_cast<vn::Index>(values.size()));
}

/// Calls `use` with the recipe of a name.
template <class Use>
void with_recipe(const std::string& learner, Options& options, const Use& use) {
  const auto checked = [&](const auto& recipe) {
    options.require_all_taken(learner);
    use(recipe);
  };
  if (learner == "PsoElm") {
    vn::Tuned<vn::Elm, vn::Pso> recipe{network_of<vn::Elm>(options), {}};
    options.take("particles", recipe.algorithm.particles);
    options.take("iterations", recipe.algorithm.iterations);
    checked(recipe);
  } else if (learner == "GaElm") {
    vn::Tuned<vn::Elm, vn::GeneticAlgorithm> recipe{network_of<vn::Elm>(options), {}};
    options.take("individuals", recipe.algorithm.individuals);
    options.take("generations", recipe.algorithm.generations);
    checked(recipe);
  } else if (learner == "Elm") {
    checked(network_of<vn::Elm>(options));
  } else if (learner == "RidgeElm") {
    checked(network_of<vn::RidgeElm>(options));
  } else if (learner == "VarProElm") {
    auto recipe = network_of<vn::VarProElm>(options);
    options.take("iterations", recipe.iterations);
    options.take("starts", recipe.starts);
    checked(recipe);
  } else if (learner == "KernelElm") {
    vn::KernelElm recipe;
    options.take_word("input_map", recipe.input_map, input_map_of);
    options.take("length_scale", recipe.length_scale);
    options.take("ridge", recipe.lambda);
    options.take("max_search_samples", recipe.max_search_samples);
    checked(recipe);
  } else {
    vn::demand(learner == "GaussianProcess", "no learner is called '", learner, "'");
    vn::GaussianProcess recipe;
    options.take_word("input_map", recipe.input_map, input_map_of);
    std::vector<double> scales;
    options.take("length_scales", scales);
    recipe.length_scales = vector_of_list(scales);
    options.take("noise_ratio", recipe.noise_ratio);
    options.take("starts", recipe.starts);
    options.take("iterations", recipe.iterations);
    options.take("max_hyper_samples", recipe.max_hyper_samples);
    checked(recipe);
  }
}

Predictor fit(const std::string& learner, const py::dict& given, const py::object& x, const py::object& y,
              const py::object& weights, std::uint64_t seed, const py::object& threads, const py::object& progress) {
  bool flat = false, one_input = false;
  const vn::MatrixX inputs = columns_of(x, "X", one_input), targets = columns_of(y, "Y", flat);
  vn::VectorX w;
  if (!weights.is_none()) w = vector_of(weights, "weights", inputs.rows());
  Options options(given.attr("copy")().cast<py::dict>());
  Predictor out{nullptr, learner, flat};
  with_recipe(learner, options, [&](const auto& recipe) {
    watched(progress, threads_of(threads), seed, [&](const vn::FitOptions& fit) {
      vn::FitOptions weighted = fit;
      if (w.size() > 0) weighted.weights = &w;
      out.map = std::make_shared<const vn::AnyPredictor>(vn::fit_any(recipe, inputs, targets, weighted));
    });
  });
  return out;
}

constexpr int pickle_schema = 1;

vn::VectorX vector_of_state(const py::handle& object) {
  const auto array = object.cast<Array>();
  return Eigen::Map<const vn::VectorX>(array.data(), array.size());
}

py::tuple state_of(const Predictor& predictor) {
  const vn::PredictorParts parts = predictor.map->parts();
  py::object spread = py::none();
  if (parts.spread)
    spread = py::make_tuple(array_of(parts.spread->inverse), array_of(parts.spread->ones), parts.spread->precision,
                            array_of(parts.spread->signal_deviation), parts.spread->noise_ratio);
  return py::make_tuple(pickle_schema, predictor.learner, predictor.flat, parts.inputs, parts.node_function,
                        parts.input_map, array_of(parts.scaling.offset), array_of(parts.scaling.factor),
                        array_of(parts.nodes), array_of(parts.coefficients), array_of(parts.offset), spread);
}

Predictor predictor_of_state(const py::tuple& state) {
  vn::demand(state.size() == 12 && state[0].cast<int>() == pickle_schema,
             "Predictor: pickled by another version of this module");
  vn::PredictorParts parts{state[3].cast<vn::Index>(), state[4].cast<int>(),
                           state[5].cast<int>(),       {vector_of_state(state[6]), vector_of_state(state[7])},
                           vector_of_state(state[8]),  {},
                           vector_of_state(state[10]), {}};
  bool flat = false;
  parts.coefficients = columns_of(state[9], "coefficients", flat);
  if (!state[11].is_none()) {
    const auto of = state[11].cast<py::tuple>();
    const vn::VectorX inverse = vector_of_state(of[0]);
    parts.spread = vn::detail::SpreadParts{{inverse.data(), inverse.data() + inverse.size()},
                                           vector_of_state(of[1]),
                                           of[2].cast<double>(),
                                           vector_of_state(of[3]),
                                           of[4].cast<double>()};
  }
  return {std::make_shared<const vn::AnyPredictor>(parts), state[1].cast<std::string>(), state[2].cast<bool>()};
}

Array shaped(const Predictor& predictor, const vn::MatrixX& values) {
  return predictor.flat ? array_of(vn::VectorX(values.col(0))) : array_of(values);
}

}  // namespace

void bind_learners(py::module_& module) {
  py::class_<Predictor>(module, "Predictor", "A fitted map from inputs to outputs.")
      .def_property_readonly(
          "inputs", [](const Predictor& p) { return p.map->inputs(); }, "Number of inputs.")
      .def_property_readonly(
          "outputs", [](const Predictor& p) { return p.map->outputs(); }, "Number of outputs.")
      .def_property_readonly(
          "nodes", [](const Predictor& p) { return p.map->nodes(); }, "Number of hidden nodes, or of kernels.")
      .def(
          "predict",
          [](const Predictor& p, const py::object& x) {
            bool flat = false;
            const vn::MatrixX inputs = columns_of(x, "X", flat);
            vn::MatrixX out;
            {
              const py::gil_scoped_release release;
              out = p.map->predict(inputs);
            }
            return shaped(p, out);
          },
          py::arg("X"), "Predictions of samples, one a row.")
      .def(
          "standard_deviation",
          [](const Predictor& p, const py::object& x) {
            bool flat = false;
            const vn::MatrixX inputs = columns_of(x, "X", flat);
            vn::MatrixX out;
            {
              const py::gil_scoped_release release;
              out = p.map->standard_deviations(inputs);
            }
            return shaped(p, out);
          },
          py::arg("X"),
          "Standard deviations of the predicted functions, without the noise of a new measurement: of a Gaussian "
          "process.")
      .def(
          "derivative",
          [](const Predictor& p, const py::object& x) {
            return array_of(p.map->derivative(vector_of(x, "x", p.map->inputs())));
          },
          py::arg("x"), "Derivative of the outputs at one sample, (outputs, inputs).")
      .def("__repr__",
           [](const Predictor& p) {
             return vn::message("<vernier.Predictor: ", p.learner, ", ", p.map->inputs(), " inputs, ", p.map->outputs(),
                                " outputs, ", p.map->nodes(), " nodes>");
           })
      .def(py::pickle(&state_of, &predictor_of_state));
  module.def("_fit", &fit, py::arg("learner"), py::arg("options"), py::arg("X"), py::arg("Y"), py::arg("weights"),
             py::arg("seed"), py::arg("threads"), py::arg("progress"), "Fits the learner of a name.");
}

}  // namespace python
