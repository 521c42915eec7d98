#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <support/allocations.hpp>
#include <support/layers/conformance.hpp>
#include <support/same_bits.hpp>
#include <vector>

namespace support {
namespace {

using support::same_bits;
using tactnet::random_stream;
using tactnet::kernels::lanes;
template <class T>
using array = tactnet::aligned_vector<T>;

constexpr double broken = std::numeric_limits<double>::quiet_NaN();

tactnet::thread_pool& pool(std::size_t threads) {
    static std::array<tactnet::thread_pool, 6> pools{tactnet::thread_pool(1), tactnet::thread_pool(1),
                                                     tactnet::thread_pool(2), tactnet::thread_pool(3),
                                                     tactnet::thread_pool(4), tactnet::thread_pool(5)};
    return pools[threads];
}

random_stream stream(std::uint32_t purpose) {
    return {20190412, tactnet::random_purposes::order, purpose};
}

/// Samples one after the other, and how the library keeps them.
using plain = std::vector<std::vector<double>>;

template <class T>
array<T> interleaved(const plain& samples, std::size_t size) {
    const std::size_t width = lanes<T>;
    array<T> result((samples.size() + width - 1) / width * width * size, T{});
    for (std::size_t s = 0; s < samples.size(); ++s)
        for (std::size_t e = 0; e < size; ++e)
            result[(s / width * size + e) * width + s % width] = static_cast<T>(samples[s][e]);
    return result;
}
template <class T>
T element(const array<T>& batch, std::size_t size, std::size_t sample, std::size_t e) {
    return batch[(sample / lanes<T> * size + e) * lanes<T> + sample % lanes<T>];
}
/// All of the first `count` samples alike, bit by bit; `from` is where they begin in the first batch.
template <class T>
bool same_bits(const array<T>& a, std::size_t from, const array<T>& b, std::size_t total, std::size_t size,
               std::size_t count) {
    for (std::size_t s = 0; s < count; ++s)
        for (std::size_t e = 0; e < size; ++e) {
            const T x = element(a, size, (from + s) % total, e), y = element(b, size, s, e);
            if (std::memcmp(&x, &y, sizeof(T)) != 0)
                return false;
        }
    return true;
}

/// Inputs all different, by more than any step of a finite difference, and none at zero: no ties, no kinks of
/// the first layer. Numbers that single precision holds.
plain distinct_inputs(std::size_t count, std::size_t size, const conformance_options& options) {
    std::vector<double> levels(count * size);
    for (std::size_t i = 0; i < levels.size(); ++i)
        levels[i] =
            static_cast<float>(options.low + (options.high - options.low) * (static_cast<double>(i) + 0.25) /
                                                 static_cast<double>(levels.size()));
    random_stream random = stream(1);
    random.shuffle(levels);
    plain result(count);
    for (std::size_t s = 0; s < count; ++s)
        result[s].assign(levels.begin() + static_cast<std::ptrdiff_t>(s * size),
                         levels.begin() + static_cast<std::ptrdiff_t>((s + 1) * size));
    return result;
}
std::vector<double> draws(std::size_t count, std::uint32_t purpose, double low = -1, double high = 1) {
    random_stream random = stream(purpose);
    std::vector<double> result(count);
    for (double& value : result)
        value = static_cast<float>(random.uniform(low, high));
    return result;
}
plain draw_samples(std::size_t count, std::size_t size, std::uint32_t purpose) {
    plain result(count);
    for (std::size_t s = 0; s < count; ++s)
        result[s] = draws(size, purpose + static_cast<std::uint32_t>(s));
    return result;
}
samples exact(const plain& values) {
    samples result;
    for (const std::vector<double>& each : values) {
        result.emplace_back();
        for (const double v : each)
            result.back().push_back({v, 0});
    }
    return result;
}

/// One layer in one precision, with parameters.
template <class T>
class subject_in {
public:
    subject_in(layer_maker<T> make, const conformance_options& options)
        : make_(make), options_(options), facts_(make()) {
        values_.resize(facts_->parameters);
        running_.resize(facts_->statistics);
        const std::vector<double> values = draws(values_.size(), 100), running = draws(running_.size(), 200);
        std::copy(values.begin(), values.end(), values_.begin());
        std::copy(running.begin(), running.end(), running_.begin());
        for (const tactnet::parameter& p : facts_->describe()) {
            if (p.role == tactnet::parameter_role::running_variance)
                for (std::size_t i = p.offset; i < p.offset + p.size; ++i)
                    running_[i] = static_cast<T>(1.25) + running_[i];
            if (p.role ==
                tactnet::parameter_role::weight) // so that many layers in a row keep the size of their values
                for (std::size_t i = p.offset; i < p.offset + p.size; ++i)
                    values_[i] =
                        static_cast<T>(static_cast<float>(values_[i]) *
                                       static_cast<float>(1 / std::sqrt(static_cast<double>(p.fan_in))));
        }
    }

    const erased_layer<T>& facts() const { return *facts_; }
    std::size_t inputs() const { return facts_->input.size(); }
    std::size_t outputs() const { return facts_->output.size(); }
    array<T>& values() { return values_; }
    const array<T>& values() const { return values_; }
    const array<T>& running() const { return running_; }

    tactnet::execution_context context(std::size_t threads) const {
        return {.threads = pool(threads),
                .epsilon = options_.epsilon,
                .momentum = 0.1,
                .seed = 7,
                .step = 3,
                .place = 2};
    }
    array<T> room(std::size_t size, std::size_t count) const {
        return array<T>((count + lanes<T> - 1) / lanes<T> * lanes<T> * size, static_cast<T>(broken));
    }
    std::unique_ptr<erased_layer<T>> fresh(std::size_t count) const {
        auto layer = make_();
        layer->resize(count);
        layer->prepare(context(1), values_.data(), running_.data());
        return layer;
    }

    array<T> infer(const array<T>& in, std::size_t count, std::size_t threads = 1) const {
        return infer_with(*fresh(count), in, count, threads);
    }
    array<T> infer_with(erased_layer<T>& layer, const array<T>& in, std::size_t count,
                        std::size_t threads = 1) const {
        array<T> out = room(outputs(), count);
        layer.infer(context(threads), values_.data(), running_.data(), count, in.data(), out.data());
        return out;
    }
    struct training {
        array<T> out, in_gradient, gradients, running;
    };
    training train(const array<T>& in, const array<T>& out_gradient, std::size_t count,
                   std::size_t threads = 1) const {
        return train_with(*fresh(count), in, out_gradient, count, threads);
    }
    training train_with(erased_layer<T>& layer, const array<T>& in, const array<T>& out_gradient,
                        std::size_t count, std::size_t threads = 1) const {
        training t{room(outputs(), count), room(inputs(), count),
                   array<T>(values_.size(), static_cast<T>(broken)), running_};
        layer.forward(context(threads), values_.data(), t.running.data(), count, in.data(), t.out.data());
        layer.backward(context(threads), values_.data(), count, in.data(), t.out.data(), out_gradient.data(),
                       t.in_gradient.data(), t.gradients.data());
        return t;
    }

private:
    layer_maker<T> make_;
    conformance_options options_;
    std::unique_ptr<erased_layer<T>> facts_;
    array<T> values_, running_;
};

template <class T>
bool same_bits(const typename subject_in<T>::training& a, const typename subject_in<T>::training& b) {
    return same_bits(a.out, b.out) && same_bits(a.in_gradient, b.in_gradient) &&
           same_bits(a.gradients, b.gradients) && same_bits(a.running, b.running);
}

template <class T>
void check_costs(const subject_in<T>& subject, const reference_layer& reference) {
    const erased_layer<T>& facts = subject.facts();
    CHECK(reference.output == extents3{facts.output.channels, facts.output.rows, facts.output.columns});
    CHECK(facts.parameters == reference.parameters);
    CHECK(facts.statistics == reference.statistics);
    CHECK(facts.multiply_adds == reference.multiply_adds);
    CHECK(facts.multiply_adds_on_pixels == reference.multiply_adds_on_pixels);
    std::vector<int> learned(facts.parameters), counted(facts.statistics);
    for (const tactnet::parameter& p : facts.describe()) {
        CAPTURE(p.name);
        CHECK(p.size ==
              std::accumulate(p.extents.begin(), p.extents.end(), std::size_t{1}, std::multiplies<>()));
        std::vector<int>& cover = learnable(p.role) ? learned : counted;
        REQUIRE(p.offset + p.size <= cover.size());
        for (std::size_t i = p.offset; i < p.offset + p.size; ++i)
            ++cover[i];
        if (p.role == tactnet::parameter_role::weight)
            CHECK(p.fan_in * p.extents[0] == p.size);
    }
    CHECK(std::all_of(learned.begin(), learned.end(), [](int n) { return n == 1; }));
    CHECK(std::all_of(counted.begin(), counted.end(), [](int n) { return n == 1; }));
}

/// Elements outside of their bounds, and the worst of them.
struct distance_report {
    std::size_t outside = 0;
    double worst = 0; // error as a share of the bound
    template <class T>
    void compare(const array<T>& found, const samples& expected, std::size_t size) {
        for (std::size_t s = 0; s < expected.size(); ++s)
            for (std::size_t e = 0; e < size; ++e)
                compare(static_cast<double>(element(found, size, s, e)), expected[s][e]);
    }
    void compare(double found, const bounded& expected) {
        outside += !within(found, expected);
        if (expected.error > 0)
            worst = std::max(worst, std::abs(found - expected.value) / expected.error);
    }
};

template <class T>
void check_results(const subject_in<T>& subject, const reference_layer& reference,
                   const conformance_options& options) {
    const std::size_t count = lanes<T> + 1; // the last lane block holds a single sample
    const plain in = distinct_inputs(count, subject.inputs(), options);
    const plain out_gradient = draw_samples(count, subject.outputs(), 300);
    std::vector<double> values(subject.facts().parameters),
        running(subject.running().begin(), subject.running().end());
    std::copy(const_cast<subject_in<T>&>(subject).values().begin(),
              const_cast<subject_in<T>&>(subject).values().end(), values.begin());
    reference_call call{values, running, false, options.epsilon, unit_roundoff<T>};
    if constexpr (std::is_same_v<T, double>)
        call.roundoff *= 2; // the reference rounds alike

    const array<T> x = interleaved<T>(in, subject.inputs());
    distance_report inference;
    inference.compare(subject.infer(x, count), reference.forward(call, exact(in)), subject.outputs());
    CAPTURE(inference.worst);
    CHECK(inference.outside == 0);
    if (options.random)
        return;

    const auto trained = subject.train(x, interleaved<T>(out_gradient, subject.outputs()), count);
    call.training = true;
    distance_report training;
    training.compare(trained.out, reference.forward(call, exact(in)), subject.outputs());
    CAPTURE(training.worst);
    CHECK(training.outside == 0);
    if (!reference.has_backward())
        return;
    const reference_gradients expected = reference.backward(call, exact(in), exact(out_gradient));
    distance_report input, parameters;
    input.compare(trained.in_gradient, expected.input, subject.inputs());
    for (std::size_t i = 0; i < trained.gradients.size(); ++i) // rounded once more when stored
        parameters.compare(static_cast<double>(trained.gradients[i]), expected.values[i]);
    CAPTURE(input.worst);
    CHECK(input.outside == 0);
    CAPTURE(parameters.worst);
    CHECK(parameters.outside == 0);
}

/// Gradients of Σ weight × output against central finite differences: along directions that move everything
/// at once, and along single coordinates.
void check_gradients(subject_in<double>& subject, const reference_layer& reference,
                     const conformance_options& options) {
    const std::size_t count = 5;
    const plain in = distinct_inputs(count, subject.inputs(), options);
    const plain weights = draw_samples(count, subject.outputs(), 400);
    const array<double> x = interleaved<double>(in, subject.inputs());
    const array<double> w = interleaved<double>(weights, subject.outputs());
    const array<double> values = subject.values();
    const auto trained = subject.train(x, w, count);

    // Bound of the rounding of one evaluation, from the reference.
    std::vector<double> plain_values(values.begin(), values.end()),
        plain_running(subject.running().begin(), subject.running().end());
    const samples bounds = reference.forward(
        {plain_values, plain_running, true, options.epsilon, unit_roundoff<double>}, exact(in));
    double rounding = 0, magnitude = 0;
    for (std::size_t s = 0; s < count; ++s)
        for (std::size_t e = 0; e < subject.outputs(); ++e) {
            magnitude += std::abs(weights[s][e] * bounds[s][e].value);
            rounding += std::abs(weights[s][e]) *
                        (bounds[s][e].error + unit_roundoff<double> * std::abs(bounds[s][e].value));
        }

    const auto layer = subject.fresh(count);
    array<double> out = subject.room(subject.outputs(), count), running = subject.running();
    const auto loss = [&](const array<double>& at, const array<double>& parameters) {
        layer->prepare(subject.context(1), parameters.data(), subject.running().data());
        layer->forward(subject.context(1), parameters.data(), running.data(), count, at.data(), out.data());
        long double sum = 0;
        for (std::size_t s = 0; s < count; ++s)
            for (std::size_t e = 0; e < subject.outputs(); ++e)
                sum += static_cast<long double>(weights[s][e]) * element(out, subject.outputs(), s, e);
        return sum;
    };
    const long double here = loss(x, values);

    std::size_t probes = 0, sharp = 0, wrong = 0;
    double worst = 0;
    const auto probe = [&](const array<double>& direction, bool of_input) {
        const array<double>& base = of_input ? x : values;
        const array<double>& gradient = of_input ? trained.in_gradient : trained.gradients;
        double expected = 0, size = 0, point = 0, largest = 0;
        for (std::size_t i = 0; i < direction.size(); ++i) {
            largest = std::max(largest, std::abs(gradient[i]));
            if (direction[i] != 0) {
                expected += gradient[i] * direction[i], size += std::abs(gradient[i] * direction[i]);
                point += unit_roundoff<double> * std::abs(gradient[i] * base[i]); // where it was moved to
            }
        }
        const auto moved = [&](double step) {
            array<double> at = base;
            for (std::size_t i = 0; i < at.size(); ++i)
                at[i] += step * direction[i];
            return of_input ? loss(at, values) : loss(x, at);
        };
        // The cube root of the relative rounding balances rounding and truncation; the distance between the
        // differences at h and 2h is three times the truncation; the second difference is what a kink in
        // between may add.
        const double scale = std::max(options.high - options.low, 1e-3) / 4;
        const double h = std::cbrt(std::clamp(rounding / magnitude, unit_roundoff<double>, 1e-9)) * scale;
        const long double up = moved(h), down = moved(-h), up2 = moved(2 * h), down2 = moved(-2 * h);
        const auto difference = static_cast<double>((up - down) / (2 * h));
        const auto wide = static_cast<double>((up2 - down2) / (4 * h));
        const auto kink = static_cast<double>(std::abs(up - 2 * here + down) / (2 * h));
        const double tolerance = std::abs(wide - difference) + kink + 2 * (rounding + point) / h +
                                 accumulated(unit_roundoff<double>, 64) * size;
        ++probes;
        wrong += !(std::abs(difference - expected) <= tolerance);
        worst = std::max(worst, std::abs(difference - expected) / tolerance);
        sharp += tolerance <= 1e-3 * (std::abs(difference) + size + largest) + 1e-6;
    };
    for (const bool of_input : {true, false}) {
        const std::size_t size = of_input ? subject.inputs() : values.size();
        if (size == 0)
            continue;
        for (std::uint32_t d = 0; d < 3; ++d) {
            if (of_input) {
                probe(interleaved<double>(draw_samples(count, size, 500 + 10 * d), size), true);
            } else {
                const std::vector<double> direction = draws(size, 600 + d);
                probe(array<double>(direction.begin(), direction.end()), false);
            }
        }
        const std::size_t all = of_input ? size * count : size, coordinates = std::min<std::size_t>(all, 12);
        for (std::size_t k = 0; k < coordinates; ++k) {
            const std::size_t i = k * (all - 1) / std::max<std::size_t>(coordinates - 1, 1);
            plain one(of_input ? count : 1, std::vector<double>(size));
            one[i / size][i % size] = 1;
            probe(of_input ? interleaved<double>(one, size) : array<double>(one[0].begin(), one[0].end()),
                  of_input);
        }
    }
    CAPTURE(worst);
    CHECK(wrong == 0);
    // Unless most probes distinguish right from wrong, the check is worth nothing.
    CHECK(3 * sharp >= 2 * probes);
}

/// Gradients in single precision beside those in double, of a layer whose reference has none: as many
/// roundings as there are terms, of numbers as large as the largest.
void check_single_gradients(const subject_in<float>& single, subject_in<double>& twice,
                            const conformance_options& options) {
    const std::size_t count = lanes<float> + 1;
    const plain in = distinct_inputs(count, single.inputs(), options);
    const plain out_gradient = draw_samples(count, single.outputs(), 300);
    std::copy(single.values().begin(), single.values().end(), twice.values().begin());
    const auto found = single.train(interleaved<float>(in, single.inputs()),
                                    interleaved<float>(out_gradient, single.outputs()), count);
    const auto expected = twice.train(interleaved<double>(in, single.inputs()),
                                      interleaved<double>(out_gradient, single.outputs()), count);
    const double rounding =
        accumulated(unit_roundoff<float>, static_cast<double>(single.inputs() + count + 16));
    const auto outside = [&](std::size_t size, const auto& is, const auto& should_be) {
        double largest = 0;
        for (std::size_t i = 0; i < size; ++i)
            largest = std::max(largest, std::abs(should_be(i)));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < size; ++i)
            wrong += !(std::abs(is(i) - should_be(i)) <= rounding * largest);
        return wrong;
    };
    const std::size_t size = single.inputs();
    CHECK(outside(
              count * size,
              [&](std::size_t i) {
                  return static_cast<double>(element(found.in_gradient, size, i / size, i % size));
              },
              [&](std::size_t i) { return element(expected.in_gradient, size, i / size, i % size); }) == 0);
    CHECK(outside(
              expected.gradients.size(),
              [&](std::size_t i) { return static_cast<double>(found.gradients[i]); },
              [&](std::size_t i) { return expected.gradients[i]; }) == 0);
}

template <class T>
void check_invariance(const subject_in<T>& subject, const conformance_options& options) {
    const std::size_t most = 3 * lanes<T> + 2, size = subject.outputs();
    const plain in = distinct_inputs(most, subject.inputs(), options);
    const plain out_gradient = draw_samples(most, size, 700);
    const auto part = [&](const plain& all, std::size_t from, std::size_t count, std::size_t each) {
        plain some;
        for (std::size_t s = 0; s < count; ++s)
            some.push_back(all[(from + s) % most]);
        return interleaved<T>(some, each);
    };
    const array<T> x = part(in, 0, most, subject.inputs()), dy = part(out_gradient, 0, most, size);
    const array<T> expected = subject.infer(x, most);

    std::size_t other_batch = 0;
    for (const std::size_t count :
         {std::size_t{1}, std::size_t{lanes<T> - 1}, std::size_t{lanes<T>}, std::size_t{lanes<T> + 1}, most})
        for (const std::size_t from : {std::size_t{0}, std::size_t{1}, std::size_t{lanes<T> + 3}})
            if (count > 0)
                other_batch +=
                    !same_bits(expected, from, subject.infer(part(in, from, count, subject.inputs()), count),
                               most, size, count);
    CHECK(other_batch == 0);

    for (const std::size_t count : {most, std::size_t{1}}) {
        const array<T> some = part(in, 0, count, subject.inputs()),
                       some_dy = part(out_gradient, 0, count, size);
        const auto inferred = subject.infer(some, count);
        const auto trained = subject.train(some, some_dy, count);
        for (const std::size_t threads : {std::size_t{2}, std::size_t{3}, std::size_t{5}}) {
            CAPTURE(threads);
            CAPTURE(count);
            CHECK(same_bits(inferred, subject.infer(some, count, threads)));
            CHECK(same_bits<T>(trained, subject.train(some, some_dy, count, threads)));
        }
        // No gradient where there is no sample: the layer in front takes that for granted.
        bool empty_lanes = true;
        for (std::size_t s = count; s < (count + lanes<T> - 1) / lanes<T> * lanes<T>; ++s)
            for (std::size_t e = 0; e < subject.inputs(); ++e)
                empty_lanes = empty_lanes && element(trained.in_gradient, subject.inputs(), s, e) == 0;
        CHECK(empty_lanes);

        // A memory that held another batch, even one of broken numbers, other parameters and other numbers of
        // threads, leaves no trace.
        const auto used = subject.fresh(most);
        plain poison = in;
        for (std::vector<double>& each : poison)
            std::fill(each.begin(), each.end(), broken);
        const array<T> poisoned = interleaved<T>(poison, subject.inputs());
        subject.infer_with(*used, poisoned, most);
        array<T> other = subject.values(), running = subject.running(), out = subject.room(size, most),
                 in_gradient = subject.room(subject.inputs(), most), gradients(other.size());
        for (T& value : other)
            value = 1 - value;
        used->prepare(subject.context(1), other.data(), running.data());
        used->forward(subject.context(2), other.data(), running.data(), most, poisoned.data(), out.data());
        used->backward(subject.context(1), other.data(), most, poisoned.data(), out.data(), dy.data(),
                       in_gradient.data(), gradients.data());
        used->resize(count);
        used->prepare(subject.context(1), subject.values().data(), subject.running().data());
        CHECK(same_bits(inferred, subject.infer_with(*used, some, count)));
        CHECK(same_bits<T>(trained, subject.train_with(*used, some, some_dy, count)));
        CHECK(same_bits<T>(trained, subject.train_with(*used, some, some_dy, count, 5)));
    }
}

template <class T>
void check_memory(subject_in<T>& subject, const conformance_options& options) {
    const std::size_t count = lanes<T> + 1;
    const array<T> x = interleaved<T>(distinct_inputs(count, subject.inputs(), options), subject.inputs());
    const array<T> dy = interleaved<T>(draw_samples(count, subject.outputs(), 800), subject.outputs());
    const auto layer = subject.fresh(count);
    array<T> out = subject.infer_with(*layer, x, count);
    const std::size_t before = allocations();
    layer->infer(subject.context(1), subject.values().data(), subject.running().data(), count, x.data(),
                 out.data());
    CHECK(allocations() == before);

    const auto expected = subject.train_with(*layer, x, dy, count);
    array<T> in_gradient = subject.room(subject.inputs(), count), gradients(expected.gradients.size());
    array<T> running = subject.running();
    // The same without anyone to ask for the input's gradient.
    layer->backward(subject.context(1), subject.values().data(), count, x.data(), expected.out.data(),
                    dy.data(), nullptr, gradients.data());
    CHECK(same_bits(gradients, expected.gradients));

    const array<T> nothing = subject.room(std::max(subject.inputs(), subject.outputs()), count);
    if (!subject.facts().keeps_output) {
        layer->backward(subject.context(1), subject.values().data(), count, x.data(), nothing.data(),
                        dy.data(), in_gradient.data(), gradients.data());
        CHECK(same_bits(in_gradient, expected.in_gradient));
        CHECK(same_bits(gradients, expected.gradients));
    }
    if (subject.facts().in_place) {
        REQUIRE(subject.inputs() == subject.outputs());
        array<T> both = x;
        layer->infer(subject.context(1), subject.values().data(), subject.running().data(), count,
                     both.data(), both.data());
        CHECK(same_bits(both, 0, out, count, subject.outputs(), count));
        both = x;
        layer->forward(subject.context(1), subject.values().data(), running.data(), count, both.data(),
                       both.data());
        CHECK(same_bits(both, 0, expected.out, count, subject.outputs(), count));
        layer->backward(subject.context(1), subject.values().data(), count, both.data(), both.data(),
                        dy.data(), in_gradient.data(), gradients.data());
        CHECK(same_bits(in_gradient, expected.in_gradient));
        CHECK(same_bits(gradients, expected.gradients));
    }
}

} // namespace

void check_conformance(const conformance_subject& given) {
    CAPTURE(given.name);
    subject_in<float> single(given.make_float, given.options);
    subject_in<double> twice(given.make_double, given.options);
    check_costs(single, given.reference);
    check_costs(twice, given.reference);
    check_results(single, given.reference, given.options);
    check_results(twice, given.reference, given.options);
    if (!given.options.random)
        check_gradients(twice, given.reference, given.options);
    if (given.reference.compares_precisions())
        check_single_gradients(single, twice, given.options);
    check_invariance(single, given.options);
    check_invariance(twice, given.options);
    check_memory(single, given.options);
    check_memory(twice, given.options);
}

} // namespace support
