#pragma once

// A support vector machine of one of the kinds that are methods of the program.

#include "methods/method.hpp"

#include <tactnet/io/svm_file.hpp>
#include <tactnet/svm.hpp>

#include <cstddef>
#include <span>
#include <utility>
#include <variant>
#include <vector>

using label_list = std::vector<std::size_t>;
using feature_list = tactnet::feature_rows<>;
using linear_machine = tactnet::linear_machine<>;
using pair_machine = tactnet::kernel_machine<tactnet::linear_kernel>;
using rbf_machine = tactnet::kernel_machine<tactnet::rbf_kernel>;
using linear_options = tactnet::linear_training_options;
/// For more features than images: see tactnet::train_linear_machine_by_products.
using product_options = tactnet::linear_product_options;
/// For a linear machine for each pair of classes.
using pair_options = tactnet::kernel_training_options<tactnet::linear_kernel>;
using rbf_options = tactnet::kernel_training_options<tactnet::rbf_kernel>;
/// Which machine, and what it is trained with.
using svm_options = std::variant<linear_options, product_options, pair_options, rbf_options>;

/// Everything but the samples that decides the result of a training.
tactnet::file_metadata describe(const svm_options& options);

/// A support vector machine of any kind.
class support_vector_machine {
public:
    support_vector_machine(linear_machine own) : own_(std::move(own)) {}
    support_vector_machine(pair_machine own) : own_(std::move(own)) {}
    support_vector_machine(rbf_machine own) : own_(std::move(own)) {}

    static support_vector_machine train(const svm_options& options, feature_list rows,
                                        const label_list& labels, tactnet::thread_pool& threads);
    /// Loads a machine of the kind of the options. Throws tactnet::file_error.
    static support_vector_machine load(const svm_options& options, const tactnet::safetensors& file);
    void add_to(tactnet::safetensors_writer& writer) const;

    std::size_t features() const;
    /// The classes that it was trained on.
    const label_list& labels() const;
    /// What its values stand for: of a machine with a kernel either, as its file says.
    tactnet::multiclass scheme() const;
    /// In a row of `values`.
    std::size_t machines() const { return tactnet::machine_count(labels().size(), scheme()); }
    /// The values that decide, a row for each row.
    std::vector<double> values(feature_list rows, tactnet::thread_pool& threads) const;
    /// What such a row stands for. The score is the smallest value in favour of the class.
    scored_class decide(std::span<const double> values) const;

private:
    std::variant<linear_machine, pair_machine, rbf_machine> own_;
};
