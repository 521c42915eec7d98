#pragma once

#include <tactnet/deployment/eight_bit/checks.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/residual/step.hpp>
#include <tactnet/operators/sequence/step.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

// Runs the steps of a stream in single precision over whole recordings, for calibration.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

[[gnu::cold]] inline void require_finite(std::span<const float> numbers, const char* what) {
    constexpr float most = 1e30F;
    for (const float number : numbers)
        if (!(std::abs(number) <= most))
            throw_invalid_argument({"deploy_stream: expected ", what,
                                    " that give finite numbers up to 1e30, found ",
                                    short_number(static_cast<double>(number))});
}

/// What calibration needs to know about some numbers.
struct stream_observation {
    double lowest = 0, highest = 0;
    std::size_t halvings =
        0; ///< the largest n for which at most a hundredth exceed the largest magnitude ÷ 2ⁿ

    [[gnu::cold]] explicit stream_observation(std::span<const float> numbers) {
        const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
        lowest = static_cast<double>(*least), highest = static_cast<double>(*most);
        constexpr std::size_t most_halvings = 24;
        float largest = std::max(std::abs(*least), std::abs(*most));
        for (; halvings < most_halvings && largest > 0; ++halvings) {
            largest /= 2;
            const auto beyond = std::count_if(numbers.begin(), numbers.end(),
                                              [&](float number) { return std::abs(number) > largest; });
            if (100 * static_cast<std::size_t>(beyond) > numbers.size())
                break;
        }
    }
};

class stream_observer {
    using map = std::vector<float>; ///< over all recordings, frame after frame

public:
    /// `frames`: of all recordings, each of which has `in_recording`.
    stream_observer(std::size_t frames, std::size_t in_recording)
        : frames_(frames), in_recording_(in_recording) {}
    /// The outputs of each step, in the order of their folded numbers.
    [[nodiscard]] const std::vector<stream_observation>& observed() const { return observed_; }

    /// Returns the map that a step writes. It adds to `added` if it ends a main branch.
    template <class... Steps>
    map run(std::type_identity<step_chain<Steps...>>, const float* folded, map in,
            const map* added = nullptr) {
        ((in = run(std::type_identity<Steps>{}, folded, in, added), folded += Steps::folded_elements), ...);
        return in;
    }
    /// The skip comes first when it runs, and last among the folded numbers.
    template <class Main, class Skip, std::size_t Stride>
    map run(std::type_identity<residual_step<Main, Skip, Stride>>, const float* folded, const map& in,
            const map*) {
        stream_observer of_skip(frames_, in_recording_);
        const map added =
            of_skip.run(std::type_identity<Skip>{}, folded + Main::folded_elements, in, nullptr);
        map out = run(std::type_identity<Main>{}, folded, in, &added);
        observed_.insert(observed_.end(), of_skip.observed_.begin(), of_skip.observed_.end());
        return out;
    }
    map run(std::type_identity<no_step>, const float*, const map& in, const map*) { return in; }
    template <class Step>
    map run(std::type_identity<Step>, const float* folded, const map& in, const map* added) {
        constexpr std::size_t outputs = Step::output.channels;
        const std::size_t features = in.size() / frames_;
        aligned_vector<float> packed(Step::packed_elements + 1), x(pad_to_cache_line(features)),
            y(pad_to_cache_line(Step::output_stride)), memory(Step::workspace_elements + 1);
        Step::pack(folded, packed.data());
        map out(frames_ * outputs);
        state_of_step<0, Step> states;
        for (std::size_t frame = 0; frame < frames_; ++frame) {
            if (frame % in_recording_ == 0)
                states = {};
            std::copy_n(in.data() + frame * features, features, x.data());
            if (added != nullptr)
                std::copy_n(added->data() + frame * outputs, outputs, y.data());
            run_step<0, Step>(packed.data(), x.data(), y.data(), memory.data(), states);
            std::copy_n(y.data(), outputs, out.data() + frame * outputs);
        }
        require_finite(out, "parameters and sequences");
        observed_.emplace_back(out);
        return out;
    }

private:
    std::size_t frames_, in_recording_;
    std::vector<stream_observation> observed_;
};

}}} // namespace tactnet::detail
