#pragma once

// A support vector machine of one of the two kinds that are methods of the program.

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
using rbf_machine = tactnet::kernel_machine<tactnet::rbf_kernel>;
using linear_options = tactnet::linear_training_options;
using rbf_options = tactnet::kernel_training_options<tactnet::rbf_kernel>;

/// A support vector machine of either kind.
class support_vector_machine {
public:
    support_vector_machine(linear_machine own) : own_(std::move(own)) {}
    support_vector_machine(rbf_machine own) : own_(std::move(own)) {}

    std::size_t features() const {
        return std::visit([](const auto& own) { return own.features(); }, own_);
    }
    /// In a row of `values`.
    std::size_t machines() const {
        const auto* kernel = std::get_if<rbf_machine>(&own_);
        return kernel != nullptr ? kernel->machines() : std::get<linear_machine>(own_).classes();
    }
    /// Of the classes that it was trained on.
    const label_list& labels() const {
        return std::visit([](const auto& own) -> const label_list& { return own.parameters().labels; }, own_);
    }
    /// What its values stand for: of a machine with a kernel either, as its file says.
    tactnet::multiclass scheme() const {
        const auto* kernel = std::get_if<rbf_machine>(&own_);
        return kernel != nullptr ? kernel->parameters().scheme : tactnet::multiclass::one_versus_rest;
    }
    void add_to(tactnet::safetensors_writer& writer) const {
        std::visit([&](const auto& own) { tactnet::add_machine(writer, own); }, own_);
    }
    /// The values that decide, a row for each row.
    std::vector<double> values(feature_list rows, tactnet::thread_pool& threads) const {
        if (const auto* linear = std::get_if<linear_machine>(&own_))
            return linear->decision_values(rows);
        return std::get<rbf_machine>(own_).decision_values(rows, threads);
    }
    /// What such a row stands for. The score is the smallest value in favour of the class.
    scored_class decide(std::span<const double> values) const;

private:
    std::variant<linear_machine, rbf_machine> own_;
};

support_vector_machine train_svm(feature_list rows, const label_list& labels, const linear_options& options,
                                 tactnet::thread_pool& threads);
support_vector_machine train_svm(feature_list rows, const label_list& labels, const rbf_options& options,
                                 tactnet::thread_pool& threads);
/// The kind is that of the options. Throws tactnet::file_error.
support_vector_machine load_svm(const tactnet::safetensors& file, const linear_options&);
support_vector_machine load_svm(const tactnet::safetensors& file, const rbf_options&);
