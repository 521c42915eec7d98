#include "methods/support_vector_machines/recipe.hpp"

#include <tactnet/features/surf_words.hpp>

#include <fmt/format.h>

#include <string>

namespace {

tactnet::file_metadata own_settings(const linear_options& o) {
    return {{"kernel", "linear"},
            {"multiclass", "one versus rest"},
            {"loss", o.solver.loss == tactnet::linear_loss::hinge ? "hinge" : "squared hinge"},
            {"bias", fmt::to_string(o.bias)},
            {"solver_seed", fmt::to_string(o.solver.seed)}};
}
std::string text(tactnet::multiclass scheme) {
    return scheme == tactnet::multiclass::one_versus_one ? "one versus one" : "one versus rest";
}
tactnet::file_metadata own_settings(const tactnet::solver_options& o) {
    return {
        {"shrinking", fmt::to_string(o.shrinking)},
        {"cache_bytes", fmt::to_string(o.cache_bytes)}, // rows that are computed apart round otherwise
    };
}
tactnet::file_metadata own_settings(const product_options& o) {
    tactnet::file_metadata all = own_settings(o.solver);
    all["kernel"] = "linear";
    all["multiclass"] = text(tactnet::multiclass::one_versus_rest);
    all["solver"] = "products";
    return all;
}
tactnet::file_metadata own_settings(const pair_options& o) {
    tactnet::file_metadata all = own_settings(o.solver);
    all["kernel"] = "linear";
    all["multiclass"] = text(o.scheme);
    return all;
}
tactnet::file_metadata own_settings(const rbf_options& o) {
    tactnet::file_metadata all = own_settings(o.solver);
    all["kernel"] = "rbf";
    all["multiclass"] = text(o.scheme);
    all["gamma_rule"] = o.kernel.gamma ? fmt::to_string(*o.kernel.gamma) : "scale";
    return all;
}

} // namespace

tactnet::file_metadata svm_recipe::describe() const {
    return std::visit(
        [](const auto& o) {
            tactnet::file_metadata text = own_settings(o);
            text["cost"] = fmt::to_string(o.cost);
            text["standardise"] = fmt::to_string(o.standardise);
            text["tolerance"] = fmt::to_string(o.solver.tolerance);
            text["iteration_limit"] = fmt::to_string(o.solver.iteration_limit);
            return text;
        },
        options);
}

const std::array<svm_recipe, 3>& svm_recipes() {
    static const std::array<svm_recipe, 3> all{{
        {"svm-linear", linear_options{.cost = 1}, 1.0f / 255},
        {"svm-rbf", rbf_options{.cost = 10}, 1},
        {"surf-svm", linear_options{.cost = tactnet::surf_settings{}.cost}},
    }};
    return all;
}
