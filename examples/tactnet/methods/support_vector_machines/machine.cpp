#include "methods/support_vector_machines/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace {

std::string text(tactnet::multiclass scheme) {
    return scheme == tactnet::multiclass::one_versus_one ? "one versus one" : "one versus rest";
}
tactnet::file_metadata own_settings(const linear_options& o) {
    return {{"kernel", "linear"},
            {"multiclass", text(tactnet::multiclass::one_versus_rest)},
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
        all["multiclass"] = text(tactnet::multiclass::one_versus_rest);
        all["solver"] = "products";
    } else {
        all["multiclass"] = text(o.scheme);
    }
    if constexpr (std::is_same_v<Options, rbf_options>) {
        all["kernel"] = "rbf";
        all["gamma_rule"] = o.kernel.gamma ? fmt::to_string(*o.kernel.gamma) : "scale";
    }
    return all;
}

} // namespace

tactnet::file_metadata describe(const svm_options& options) {
    return std::visit(
        [](const auto& o) {
            tactnet::file_metadata all = own_settings(o);
            all["cost"] = fmt::to_string(o.cost);
            all["standardise"] = fmt::to_string(o.standardise);
            all["tolerance"] = fmt::to_string(o.solver.tolerance);
            all["iteration_limit"] = fmt::to_string(o.solver.iteration_limit);
            return all;
        },
        options);
}

support_vector_machine support_vector_machine::train(const svm_options& options, feature_list rows,
                                                     const label_list& labels,
                                                     tactnet::thread_pool& threads) {
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

support_vector_machine support_vector_machine::load(const svm_options& options,
                                                    const tactnet::safetensors& file) {
    if (std::holds_alternative<pair_options>(options))
        return tactnet::load_kernel_machine<tactnet::linear_kernel>(file);
    if (std::holds_alternative<rbf_options>(options))
        return tactnet::load_kernel_machine<tactnet::rbf_kernel>(file);
    return tactnet::load_linear_machine(file);
}

scored_class support_vector_machine::decide(std::span<const double> row) const {
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
