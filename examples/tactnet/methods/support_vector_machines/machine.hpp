#pragma once

// A support vector machine of one of the kinds that are methods of the program.

#include "methods/method.hpp"

#include <tactnet/io/svm_file.hpp>
#include <tactnet/svm.hpp>

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

/// Everything but the samples that decides the result of a training.
tactnet::file_metadata describe(const svm_options& options);

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
                                        const label_list& labels, tactnet::thread_pool& threads);
    /// Loads a machine of the kind of the options. Throws tactnet::file_error.
    static support_vector_machine load(const svm_options& options, const tactnet::safetensors& file);

    /// In a row of `values`.
    std::size_t machines() const { return tactnet::machine_count(labels.size(), scheme); }
    /// What such a row stands for. The score is the smallest value in favour of the class.
    scored_class decide(std::span<const double> row) const;
};
