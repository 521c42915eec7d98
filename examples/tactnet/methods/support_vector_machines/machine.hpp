#pragma once

// A support vector machine of one of the kinds that are methods of the program.

#include "methods/method.hpp"

#include <tactnet/io/svm_file.hpp>
#include <tactnet/svm.hpp>

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

using label_list = std::vector<std::size_t>;
using feature_list = tactnet::feature_rows<>;
using linear_options = tactnet::linear_training_options;
/// For more features than images: see tactnet::train_linear_machine_by_products.
using product_options = tactnet::linear_product_options;
/// For a linear machine for each pair of classes.
using pair_options = tactnet::kernel_training_options<tactnet::linear_kernel>;
using rbf_options = tactnet::kernel_training_options<tactnet::rbf_kernel>;
/// Which machine, and what it is trained with.
using svm_options = std::variant<linear_options, product_options, pair_options, rbf_options>;

namespace detail {

inline std::string scheme_text(tactnet::multiclass scheme) {
    return scheme == tactnet::multiclass::one_versus_one ? "one versus one" : "one versus rest";
}
inline tactnet::file_metadata own_settings(const linear_options& o) {
    return {{"kernel", "linear"},
            {"multiclass", scheme_text(tactnet::multiclass::one_versus_rest)},
            {"loss", o.solver.loss == tactnet::linear_loss::hinge ? "hinge" : "squared hinge"},
            {"bias", fmt::to_string(o.bias)},
            {"solver_seed", fmt::to_string(o.solver.seed)}};
}
template <class Options>
tactnet::file_metadata own_settings(const Options& o) {
    tactnet::file_metadata all{
        {"shrinking", fmt::to_string(o.solver.shrinking)},
        {"cache_bytes", fmt::to_string(o.solver.cache_bytes)}, // rows that are computed apart round otherwise
        {"kernel", "linear"}};
    if constexpr (std::is_same_v<Options, product_options>) {
        all["multiclass"] = scheme_text(tactnet::multiclass::one_versus_rest);
        all["solver"] = "products";
    } else {
        all["multiclass"] = scheme_text(o.scheme);
    }
    if constexpr (std::is_same_v<Options, rbf_options>) {
        all["kernel"] = "rbf";
        all["gamma_rule"] = o.kernel.gamma ? fmt::to_string(*o.kernel.gamma) : "scale";
    }
    return all;
}

} // namespace detail

/// Everything but the samples that decides the result of a training.
inline tactnet::file_metadata describe(const svm_options& options) {
    return std::visit(
        [](const auto& o) {
            tactnet::file_metadata all = detail::own_settings(o);
            all["cost"] = fmt::to_string(o.cost);
            all["standardise"] = fmt::to_string(o.standardise);
            all["tolerance"] = fmt::to_string(o.solver.tolerance);
            all["iteration_limit"] = fmt::to_string(o.solver.iteration_limit);
            return all;
        },
        options);
}

/// A support vector machine of any kind, trained.
struct support_vector_machine {
    std::size_t features;
    label_list labels; ///< the classes that it was trained on
    /// What its values stand for: of a machine with a kernel either, as its file says.
    tactnet::multiclass scheme = tactnet::multiclass::one_versus_rest;
    /// The values that decide, a row for each row.
    std::function<std::vector<double>(feature_list rows, tactnet::thread_pool& threads)> values;
    std::function<void(tactnet::safetensors_writer& writer)> add_to;

    template <class Own>
    support_vector_machine(Own machine) {
        const auto own = std::make_shared<const Own>(std::move(machine));
        features = own->features();
        labels = own->parameters().labels;
        if constexpr (requires { own->parameters().scheme; })
            scheme = own->parameters().scheme;
        values = [own](feature_list rows, tactnet::thread_pool& threads) {
            if constexpr (requires { own->decision_values(rows, threads); })
                return own->decision_values(rows, threads);
            else
                return own->decision_values(rows);
        };
        add_to = [own](tactnet::safetensors_writer& writer) { tactnet::add_machine(writer, *own); };
    }

    static support_vector_machine train(const svm_options& options, feature_list rows,
                                        const label_list& labels, tactnet::thread_pool& threads) {
        return std::visit(
            [&]<class Options>(const Options& o) -> support_vector_machine {
                if constexpr (std::is_same_v<Options, linear_options>)
                    return tactnet::train_linear_machine(rows, labels, o, threads).machine;
                else if constexpr (std::is_same_v<Options, product_options>)
                    return tactnet::train_linear_machine_by_products(rows, labels, o, threads).machine;
                else
                    return tactnet::train_kernel_machine(rows, labels, o, threads).machine;
            },
            options);
    }
    /// Loads a machine of the kind of the options. Throws tactnet::file_error.
    static support_vector_machine load(const svm_options& options, const tactnet::safetensors& file) {
        if (std::holds_alternative<pair_options>(options))
            return tactnet::load_kernel_machine<tactnet::linear_kernel>(file);
        if (std::holds_alternative<rbf_options>(options))
            return tactnet::load_kernel_machine<tactnet::rbf_kernel>(file);
        return tactnet::load_linear_machine(file);
    }

    /// In a row of `values`.
    std::size_t machines() const { return tactnet::machine_count(labels.size(), scheme); }
    /// What such a row stands for. The score is the smallest value in favour of the class.
    scored_class decide(std::span<const double> row) const {
        const std::size_t found = tactnet::winning_class(row, labels.size(), scheme);
        double score = std::numeric_limits<double>::infinity();
        if (scheme == tactnet::multiclass::one_versus_rest) {
            score = row[found];
        } else { // a value for each pair: of two classes a single one
            std::size_t m = 0;
            for (const auto& [first, second] : tactnet::class_pairs(labels.size())) {
                if (first == found || second == found)
                    score = std::min(score, first == found ? row[m] : -row[m]);
                ++m;
            }
        }
        if (!std::isfinite(score))
            throw std::runtime_error(
                "expected finite decision values, found some that are not: the weights are broken");
        return {labels[found], score};
    }
};
