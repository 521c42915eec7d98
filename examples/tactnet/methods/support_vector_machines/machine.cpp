#include "methods/support_vector_machines/machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

scored_class support_vector_machine::decide(std::span<const double> values) const {
    const std::size_t classes = labels().size();
    const tactnet::multiclass by = scheme();
    const std::size_t found = tactnet::decide(values, classes, by);
    double score = std::numeric_limits<double>::infinity();
    if (by == tactnet::multiclass::one_versus_rest) {
        score = values[found];
    } else { // a value for each pair: of two classes a single one
        std::size_t m = 0;
        for (const auto& [first, second] : tactnet::class_pairs(classes)) {
            if (first == found || second == found)
                score = std::min(score, first == found ? values[m] : -values[m]);
            ++m;
        }
    }
    if (!std::isfinite(score))
        throw std::runtime_error(
            "expected finite decision values, found some that are not: the weights are broken");
    return {labels()[found], score};
}

support_vector_machine train_svm(feature_list rows, const label_list& labels, const linear_options& options,
                                 tactnet::thread_pool& threads) {
    return tactnet::train_linear_machine(rows, labels, options, threads).machine;
}
support_vector_machine train_svm(feature_list rows, const label_list& labels, const product_options& options,
                                 tactnet::thread_pool& threads) {
    return tactnet::train_linear_machine_by_products(rows, labels, options, threads).machine;
}
support_vector_machine train_svm(feature_list rows, const label_list& labels, const pair_options& options,
                                 tactnet::thread_pool& threads) {
    return tactnet::train_kernel_machine(rows, labels, options, threads).machine;
}
support_vector_machine train_svm(feature_list rows, const label_list& labels, const rbf_options& options,
                                 tactnet::thread_pool& threads) {
    return tactnet::train_kernel_machine(rows, labels, options, threads).machine;
}
support_vector_machine load_svm(const tactnet::safetensors& file, const linear_options&) {
    return tactnet::load_linear_machine(file);
}
support_vector_machine load_svm(const tactnet::safetensors& file, const product_options&) {
    return tactnet::load_linear_machine(file);
}
support_vector_machine load_svm(const tactnet::safetensors& file, const pair_options&) {
    return tactnet::load_kernel_machine<tactnet::linear_kernel>(file);
}
support_vector_machine load_svm(const tactnet::safetensors& file, const rbf_options&) {
    return tactnet::load_kernel_machine<tactnet::rbf_kernel>(file);
}
