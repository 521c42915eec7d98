#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/svm/multiclass.hpp>
#include <tactnet/svm/probability.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The parameters of a trained machine, which a file stores.
template <svm_kernel Kernel>
struct kernel_machine_parameters {
    Kernel kernel; ///< fitted
    multiclass scheme = multiclass::one_versus_one;
    std::size_t features = 0;
    std::vector<std::size_t> labels;         ///< of the classes, rising
    std::vector<std::size_t> support_counts; ///< support vectors of each class
    std::vector<float> support_vectors;      ///< by class, standardised if `standardise` is set
    /// A row for each support vector. One versus one: its signed coefficients against the other classes in
    /// order; one versus rest: those in the machines of all classes.
    std::vector<double> coefficients;
    std::vector<double> offsets;         ///< of each machine
    std::vector<platt_sigmoid> sigmoids; ///< of each machine, or none
    std::optional<standardisation> standardise;

    /// Values in a row of coefficients.
    [[nodiscard]] std::size_t coefficients_each() const {
        return scheme == multiclass::one_versus_one ? labels.size() - 1 : labels.size();
    }
    /// Throws std::invalid_argument, naming the part, when the parts do not fit each other.
    void check() const;
};

/// A trained support vector machine with a kernel. All machines share their support vectors: a batch is one
/// product with all of these, one exponential of each pair, and one small sum. Any number of threads may call
/// const members. The result of a row is bit-identical alone and in any batch.
template <svm_kernel Kernel, std::size_t Features = dynamic_features>
class kernel_machine {
public:
    /// Throws std::invalid_argument when the parameters do not fit each other or `Features`.
    explicit kernel_machine(kernel_machine_parameters<Kernel> parameters) : parts_(std::move(parameters)) {
        parts_.check();
        if (Features != dynamic_features && parts_.features != Features)
            detail::throw_invalid_argument(
                {"kernel machine: expected ", Features, " features, found ", parts_.features});
        const feature_rows<> vectors(parts_.support_vectors, parts_.features);
        const std::vector<std::size_t> all = all_samples(vectors.size());
        space_ = kernel_space<Kernel>(vectors);
        columns_ = kernel_columns<Kernel>(space_.place(vectors), all, space_.scale());
        const std::size_t each = parts_.coefficients_each();
        width_ = kernels::padded_size<double>(each);
        coefficients_.resize(all.size() * width_);
        for (const std::size_t v : all)
            std::copy_n(parts_.coefficients.data() + v * each, each, coefficients_.data() + v * width_);
    }
    // The packed support vectors point to the originals.
    kernel_machine(const kernel_machine& other) : kernel_machine(other.parts_) {}
    kernel_machine(kernel_machine&&) noexcept = default;
    kernel_machine& operator=(kernel_machine&&) noexcept = default;
    kernel_machine& operator=(const kernel_machine& other) { return *this = kernel_machine(other); }
    ~kernel_machine() = default;

    [[nodiscard]] const kernel_machine_parameters<Kernel>& parameters() const { return parts_; }
    [[nodiscard]] std::size_t features() const { return parts_.features; }
    [[nodiscard]] std::size_t classes() const { return parts_.labels.size(); }
    [[nodiscard]] std::size_t machines() const { return parts_.offsets.size(); }
    [[nodiscard]] std::size_t support_vectors() const { return columns_.size(); }

    /// The value of every machine for every row, row by row. One versus one: above zero for the first class
    /// of the pair, in the order of class_pairs. Throws std::invalid_argument for a feature that is not
    /// finite.
    [[nodiscard]] std::vector<double> decision_values(feature_rows<Features> rows,
                                                      thread_pool& threads) const {
        check_rows(rows);
        std::vector<double> values(rows.size() * machines());
        find_values(rows, values, threads);
        return values;
    }
    /// The label of every row. Decision values are not kept, so memory grows with the labels alone.
    [[nodiscard]] std::vector<std::size_t> predict(feature_rows<Features> rows, thread_pool& threads) const {
        std::vector<std::size_t> labels;
        for_each_values(rows, threads, [&](std::span<const double> values) {
            labels.push_back(parts_.labels[winning_class(values, classes(), parts_.scheme)]);
        });
        return labels;
    }
    /// The label of one row.
    [[nodiscard]] std::size_t predict(std::span<const float, Features> row) const {
        thread_pool alone;
        return predict(feature_rows<Features>(row, row.size()), alone).front();
    }
    /// A row of probabilities for every row, in the order of the labels. Throws std::logic_error unless
    /// trained for them.
    [[nodiscard]] std::vector<double> probabilities(feature_rows<Features> rows, thread_pool& threads) const {
        if (parts_.sigmoids.empty())
            throw std::logic_error("kernel machine: it was trained without probabilities");
        std::vector<double> result;
        for_each_values(rows, threads, [&](std::span<const double> values) {
            const std::vector<double> p = probabilities_of(values);
            result.insert(result.end(), p.begin(), p.end());
        });
        return result;
    }

private:
    /// The rows of a block, whose kernel values stay in the cache.
    static constexpr std::size_t block_rows = 8 * kernels::packed_rows::block_rows;

    void check_rows(feature_rows<Features> rows) const {
        if (classes() == 0)
            throw std::logic_error("kernel machine: it has been moved from");
        if (rows.features() != features())
            detail::throw_invalid_argument(
                {"kernel machine: expected rows of ", features(), " features, found ", rows.features()});
        check_finite(rows);
    }
    void find_values(feature_rows<Features> rows, std::span<double> values, thread_pool& threads) const {
        const std::size_t blocks = detail::ceil_div(rows.size(), block_rows);
        threads.for_each(blocks, [&](std::size_t block) {
            const std::size_t first = block * block_rows, count = std::min(block_rows, rows.size() - first);
            evaluate({rows.values().subspan(first * features(), count * features()), features()},
                     values.subspan(first * machines(), count * machines()));
        });
    }
    /// Calls take(values) for each row.
    template <class Take>
    void for_each_values(feature_rows<Features> rows, thread_pool& threads, const Take& take) const {
        check_rows(rows);
        std::vector<double> values;
        detail::for_each_block(rows, machines() * sizeof(double), [&](feature_rows<Features> block) {
            values.resize(block.size() * machines());
            find_values(block, values, threads);
            for (std::size_t i = 0; i < block.size(); ++i)
                take(std::span<const double>(values).subspan(i * machines(), machines()));
        });
    }
    void evaluate(feature_rows<> rows, std::span<double> values) const {
        const standardised_rows used(rows, parts_.standardise);
        const placed_rows placed = space_.place(used.rows());
        const std::size_t stride = columns_.padded_size();
        aligned_vector<float> kernel_values(rows.size() * stride);
        columns_.measure(placed, 0, rows.size(), kernel_values.data(), stride);
        parts_.kernel.apply(kernel_values.data(), kernel_values.size(), space_.unit());
        const bool pairs = parts_.scheme == multiclass::one_versus_one;
        aligned_vector<double> sums((pairs ? classes() : 1) * width_);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::span<double> out = values.subspan(i * machines(), machines());
            const float* weights = kernel_values.data() + i * stride;
            std::copy(parts_.offsets.begin(), parts_.offsets.end(), out.begin());
            if (pairs) {
                add_pairs(weights, sums, out);
            } else {
                kernels::weighted_row_sums(weights, coefficients_.data(), support_vectors(), width_,
                                           sums.data());
                for (std::size_t c = 0; c < classes(); ++c)
                    out[c] += sums[c];
            }
        }
    }
    void add_pairs(const float* weights, std::span<double> sums, std::span<double> out) const {
        std::size_t first = 0;
        for (std::size_t c = 0; c < classes(); ++c) {
            const std::size_t count = parts_.support_counts[c];
            kernels::weighted_row_sums(weights + first, coefficients_.data() + first * width_, count, width_,
                                       sums.data() + c * width_);
            first += count;
        }
        std::size_t machine = 0;
        for (std::size_t a = 0; a < classes(); ++a)
            for (std::size_t b = a + 1; b < classes(); ++b)
                out[machine++] += sums[a * width_ + b - 1] + sums[b * width_ + a];
    }
    [[nodiscard]] std::vector<double> probabilities_of(std::span<const double> values) const {
        // Away from 0 and 1, since coupling divides by them.
        constexpr double least = 1e-7;
        const std::size_t k = classes();
        if (parts_.scheme == multiclass::one_versus_rest) {
            std::vector<double> p;
            for (std::size_t c = 0; c < k; ++c)
                p.push_back(std::max(parts_.sigmoids[c].probability(values[c]), least));
            const double sum = std::accumulate(p.begin(), p.end(), 0.0);
            for (double& value : p)
                value /= sum;
            return p;
        }
        std::vector<double> pairwise(k * k);
        std::size_t machine = 0;
        for (std::size_t a = 0; a < k; ++a)
            for (std::size_t b = a + 1; b < k; ++b, ++machine) {
                const double p =
                    std::clamp(parts_.sigmoids[machine].probability(values[machine]), least, 1 - least);
                pairwise[a * k + b] = p;
                pairwise[b * k + a] = 1 - p;
            }
        if (k == 2)
            return {pairwise[1], pairwise[2]};
        return couple_pairwise(pairwise, k);
    }

    kernel_machine_parameters<Kernel> parts_;
    kernel_space<Kernel> space_;
    kernel_columns<Kernel> columns_;
    std::size_t width_ = 0;
    aligned_vector<double> coefficients_; // rows padded to whole vectors
};

template <svm_kernel Kernel>
void kernel_machine_parameters<Kernel>::check() const {
    const auto require = [](bool right, const char* what, std::size_t expected, std::size_t found) {
        if (!right)
            detail::throw_invalid_argument(
                {"kernel machine: ", what, ": expected ", expected, ", found ", found});
    };
    const auto require_same = [&](const char* what, std::size_t expected, std::size_t found) {
        require(expected == found, what, expected, found);
    };
    const std::size_t k = labels.size(), machines = machine_count(k, scheme);
    require(k >= 2, "classes, at least", 2, k);
    require(features >= 1, "features, at least", 1, features);
    require(std::adjacent_find(labels.begin(), labels.end(),
                               [](std::size_t a, std::size_t b) { return a >= b; }) == labels.end(),
            "distinct labels in rising order", k, 0);
    require_same("counts of support vectors", k, support_counts.size());
    const std::size_t vectors = support_vectors.size() / features;
    require(vectors >= 1, "support vectors, at least", 1, vectors); // none hold any number of features
    require_same("values of support vectors", vectors * features, support_vectors.size());
    std::size_t counted = 0;
    for (const std::size_t count : support_counts) {
        require(count <= vectors - counted, "support vectors, at most", vectors, count);
        counted += count;
    }
    require_same("support vectors", counted, vectors);
    require_same("coefficients", vectors * coefficients_each(), coefficients.size());
    require_same("offsets", machines, offsets.size());
    if (!sigmoids.empty())
        require_same("sigmoids", machines, sigmoids.size());
    if (standardise) {
        require_same("means", features, standardise->mean.size());
        require_same("deviations", features, standardise->deviation.size());
    }
}

}} // namespace tactnet
