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

/// A support vector machine of any kind.
class support_vector_machine {
public:
    support_vector_machine(linear_machine own) : own_(std::move(own)) {}
    support_vector_machine(pair_machine own) : own_(std::move(own)) {}
    support_vector_machine(rbf_machine own) : own_(std::move(own)) {}

    std::size_t features() const {
        return std::visit([](const auto& own) { return own.features(); }, own_);
    }
    /// In a row of `values`.
    std::size_t machines() const { return tactnet::machine_count(labels().size(), scheme()); }
    /// Of the classes that it was trained on.
    const label_list& labels() const {
        return std::visit([](const auto& own) -> const label_list& { return own.parameters().labels; }, own_);
    }
    /// What its values stand for: of a machine with a kernel either, as its file says.
    tactnet::multiclass scheme() const {
        return std::visit(
            [](const auto& own) {
                if constexpr (requires { own.parameters().scheme; })
                    return own.parameters().scheme;
                else
                    return tactnet::multiclass::one_versus_rest;
            },
            own_);
    }
    void add_to(tactnet::safetensors_writer& writer) const {
        std::visit([&](const auto& own) { tactnet::add_machine(writer, own); }, own_);
    }
    /// The values that decide, a row for each row.
    std::vector<double> values(feature_list rows, tactnet::thread_pool& threads) const {
        return std::visit(
            [&](const auto& own) {
                if constexpr (requires { own.decision_values(rows, threads); })
                    return own.decision_values(rows, threads);
                else
                    return own.decision_values(rows);
            },
            own_);
    }
    /// What such a row stands for. The score is the smallest value in favour of the class.
    scored_class decide(std::span<const double> values) const;

private:
    std::variant<linear_machine, pair_machine, rbf_machine> own_;
};

support_vector_machine train_svm(feature_list rows, const label_list& labels, const linear_options& options,
                                 tactnet::thread_pool& threads);
support_vector_machine train_svm(feature_list rows, const label_list& labels, const product_options& options,
                                 tactnet::thread_pool& threads);
support_vector_machine train_svm(feature_list rows, const label_list& labels, const pair_options& options,
                                 tactnet::thread_pool& threads);
support_vector_machine train_svm(feature_list rows, const label_list& labels, const rbf_options& options,
                                 tactnet::thread_pool& threads);
/// The kind is that of the options. Throws tactnet::file_error.
support_vector_machine load_svm(const tactnet::safetensors& file, const linear_options&);
support_vector_machine load_svm(const tactnet::safetensors& file, const product_options&);
support_vector_machine load_svm(const tactnet::safetensors& file, const pair_options&);
support_vector_machine load_svm(const tactnet::safetensors& file, const rbf_options&);
