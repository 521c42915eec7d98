#pragma once

#include <tactnet/networks/model.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/metrics.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The results of a network on labelled samples.
struct evaluation {
    double loss = 0; ///< mean cross-entropy
    confusion_matrix confusion;
    std::vector<std::size_t> recognised; ///< class of each chosen sample
    std::vector<float> logits{};         ///< of each chosen sample a row, one per class
};

/// Which variants of a sample an evaluation averages over: the reflections that a rule allows, with the
/// outputs of partners exchanged.
struct test_time_augmentation : reflection_rule {
    test_time_augmentation() = default;
    test_time_augmentation(reflection_rule rule) : reflection_rule(std::move(rule)) {}
    static const test_time_augmentation none, reflections; ///< the image alone; all_reflections
};
inline const test_time_augmentation test_time_augmentation::none{};
inline const test_time_augmentation test_time_augmentation::reflections{reflection_rule::all()};

namespace detail {

/// `logits` puts a batch of inputs through a network.
using logits_of_batch = std::function<void(const sample_batch&, sample_batch&)>;

/// The logits of the chosen samples, normalised and reflected.
inline void logits_of_samples(shape input, std::span<const float> mean, float scale,
                              const input_function& function, const labelled_samples& samples,
                              std::span<const std::size_t> chosen, reflection how,
                              const logits_of_batch& logits, sample_batch& out) {
    std::vector<float> sample(mean.size()), reflected(mean.size());
    sample_batch in(mean.size(), chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        samples.copy(chosen[i], sample);
        reflect_image(input, how, sample.data(), reflected.data());
        function.apply(reflected);
        for (std::size_t e = 0; e < mean.size(); ++e)
            reflected[e] = (reflected[e] - mean[e]) * scale;
        in.set(i, reflected);
    }
    logits(in, out);
}

/// The outputs of one sample of a batch.
struct sample_outputs {
    const sample_batch& batch;
    std::size_t sample;
    float operator[](std::size_t output) const { return batch(sample, output); }
};

inline evaluation evaluate(shape input, std::span<const float> mean, float scale, std::size_t outputs,
                           const labelled_samples& samples, std::span<const std::size_t> chosen,
                           const test_time_augmentation& how, const logits_of_batch& logits,
                           const input_function& function = {}) {
    samples.check_classes(chosen);
    check_partners("evaluate", how, outputs);
    constexpr std::size_t at_once = 64;
    evaluation result{0, confusion_matrix(samples.classes()), {}, {}};
    std::vector<float> of_classes(samples.classes());
    for (std::size_t first = 0; first < chosen.size(); first += at_once) {
        const std::size_t count = std::min(at_once, chosen.size() - first);
        const auto part = chosen.subspan(first, count);
        sample_batch out(outputs, count), gradient(outputs, count);
        std::array<sample_batch, 4> all{out, out, out, out};
        for (std::size_t r = 0; r < all.size(); ++r)
            if (all_reflections[r].within(how.axes()))
                logits_of_samples(input, mean, scale, function, samples, part, all_reflections[r], logits,
                                  all[r]);
        std::vector<float> row(outputs);
        for (std::size_t i = 0; i < count; ++i) {
            how.average([&](std::size_t r) { return sample_outputs{all[r], i}; }, row);
            out.set(i, row);
        }
        std::vector<std::size_t> labels(count);
        for (std::size_t i = 0; i < count; ++i)
            labels[i] = samples.label(part[i]);
        const double loss = softmax_cross_entropy<float>({count, outputs, sample_batch::lanes}, out.data(),
                                                         labels, samples.classes(), 0.0, gradient.data());
        result.loss += loss * static_cast<double>(count) / static_cast<double>(chosen.size());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < samples.classes(); ++c)
                of_classes[c] = out(i, c);
            result.logits.insert(result.logits.end(), of_classes.begin(), of_classes.end());
            const std::size_t best = first_largest(of_classes);
            result.recognised.push_back(best);
            result.confusion.add(labels[i], best);
        }
    }
    return result;
}

} // namespace detail

/// Evaluates a network on chosen images or features. Only the outputs of the classes count. If logits are not
/// finite, neither is the loss, and the recognised classes are meaningless. Features cannot be reflected.
/// Throws as `labelled_samples::check` and `check_classes`.
template <class Network>
[[nodiscard]] evaluation evaluate(const Network& network,
                                  const normalisation<Network::input_shape>& normalise,
                                  const labelled_samples& samples, std::span<const std::size_t> chosen,
                                  thread_pool& threads, const test_time_augmentation& how = {}) {
    samples.check(Network::input_shape, Network::outputs);
    typename Network::workspace space;
    network.prepare(threads, space);
    return detail::evaluate(
        Network::input_shape, normalise.mean.view().elements(), normalise.scale, Network::outputs, samples,
        chosen, how,
        [&](const sample_batch& in, sample_batch& out) {
            network.logits({in.data(), in.samples()}, {out.data(), out.samples()}, threads, space);
        },
        normalise.function);
}

}} // namespace tactnet
