#pragma once

#include <tactnet/deployment/batch.hpp>
#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/networks/model.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/operators/sequence/lowering.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// `require<View>(call, folded)` throws std::invalid_argument for finite numbers that a format cannot hold. 8
/// bits specialise it in deployment/eight_bit.
template <class Format>
struct folded_check;
template <>
struct folded_check<single_precision> {
    template <class View>
    static void require(const char*, std::span<const float>) {}
};

// Wrong arguments are reported out of line, compiled once for networks of all types.

[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_not_finite(bool of_input, float found) {
    throw_invalid_argument({"deploy: expected ",
                            of_input ? "a mean and a scale" : "parameters and variances + epsilon above zero",
                            " that give finite numbers up to 1e30, found ", std::to_string(found),
                            " once batch norms are folded in"});
}
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_folded(float found, std::size_t place) {
    throw_invalid_argument(
        {"deploy: expected finite numbers, found ", std::to_string(found), " at place ", place});
}
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_class_count(std::size_t outputs,
                                                                        std::size_t found) {
    throw_invalid_argument(
        {"deploy: expected a model that names 1 to ", outputs, " classes, found ", found, " names"});
}
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_class_name(const std::string& found) {
    if (found.empty())
        throw_invalid_argument({"deploy: expected names of classes, each once, found an empty one"});
    throw_invalid_argument({"deploy: expected names of classes, each once, found ", quoted{found}, " twice"});
}

} // namespace detail

/// A deployed network, which keeps its packed weights on the heap. Copyable and movable.
///
///     const auto network = deploy(model);
///     if (const auto found = network.classify(frame)) // index, probability and name
///         show(found->name);
///
/// Calls with one frame use no heap, are `noexcept`, and any number of threads may call the same object.
/// Their last argument may be a `workspace`; otherwise they take workspace_bytes of the stack.
template <class Network, class Format = single_precision>
class deployed : detail::refused_calls<Network::input_shape, Network::outputs> {
    using lowered = lowered_network<Network, Format>;

public:
    using view_type = deployed_view<Network::input_shape, typename lowered::step>;
    using activation = typename Format::activation;
    using workspace = typename view_type::workspace;
    static constexpr shape input_shape = Network::input_shape;
    static constexpr std::size_t outputs = view_type::outputs;
    static constexpr std::size_t weight_bytes = view_type::weight_bytes;
    static constexpr std::size_t workspace_bytes = view_type::workspace_bytes;
    static_assert(std::is_same_v<typename Network::value_type, float>,
                  "deploy: networks are deployed in single precision; this one has another number type");

    /// The input is (count − mean) × scale, of compressed counts after set_input_function. Throws
    /// std::invalid_argument if the mean, the scale or a
    /// parameter is NaN, infinite or beyond 1e30 once batch norms are folded in.
    deployed(const Network& network, std::span<const float, input_shape.size()> mean, float scale)
        requires std::is_same_v<Format, single_precision>
        : folded_(view_type::folded_elements), packed_(view_type::packed_elements) {
        std::copy(mean.begin(), mean.end(), folded_.begin());
        folded_[input_shape.size()] = scale;
        lowered::fold(
            {network.learnable_values().data(), network.running_statistics().data(), network.epsilon},
            folded_.data() + view_type::steps_folded);
        for (std::size_t i = 0; i < folded_.size(); ++i)
            if (!(std::abs(folded_[i]) <= largest_parameter))
                detail::throw_not_finite(i <= input_shape.size(), folded_[i]);
        set_limit();
        view_type::pack(folded_.data(), packed_.data());
    }
    /// A trained network with its normalisation and the names of its classes. Throws as set_classes and
    /// set_temperature, and for a network whose weights are all zero, too.
    explicit deployed(const model<Network>& trained)
        requires std::is_same_v<Format, single_precision>
        : deployed(trained.network, trained.normalise.mean.view().elements(), trained.normalise.scale) {
        detail::check_trained("deploy", trained.network);
        set_classes(trained.classes);
        set_temperature(trained.temperature);
        set_input_function(trained.normalise.function);
        set_reflections(trained.reflections);
    }
    /// From folded numbers, as folded() returns them. Throws std::invalid_argument if one is NaN or infinite,
    /// or if the number format cannot hold it.
    explicit deployed(std::span<const float, view_type::folded_elements> folded)
        : folded_(view_type::folded_elements), packed_(view_type::packed_elements) {
        for (std::size_t i = 0; i < folded.size(); ++i) {
            if (!(std::abs(folded[i]) <= std::numeric_limits<float>::max()))
                detail::throw_folded(folded[i], i);
            folded_[i] = folded[i];
        }
        detail::folded_check<Format>::template require<view_type>("deploy", folded);
        view_type::pack(folded_.data(), packed_.data());
    }

    /// Names the classes of the first outputs, in order. Throws std::invalid_argument unless
    /// there are 1 to `outputs` names, each once and none empty.
    void set_classes(std::vector<std::string> names) {
        if (names.empty() || names.size() > outputs)
            detail::throw_class_count(outputs, names.size());
        for (std::size_t c = 0; c < names.size(); ++c)
            if (names[c].empty() || std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(c),
                                              names[c]) != names.begin() + static_cast<std::ptrdiff_t>(c))
                detail::throw_class_name(names[c]);
        classes_ = std::move(names);
    }
    /// The names of the classes; empty if they have none.
    [[nodiscard]] std::span<const std::string> classes() const& noexcept { return classes_; }
    std::span<const std::string> classes() const&& = delete;
    /// The number of classes: of names, if there are any, otherwise of outputs. Further outputs are unused.
    [[nodiscard]] std::size_t class_count() const noexcept {
        return classes_.empty() ? outputs : classes_.size();
    }

    /// Sets what logits are divided by for the probabilities of `classify`, as fit_temperature finds it.
    /// Throws std::invalid_argument unless is_temperature(temperature).
    void set_temperature(double temperature) {
        detail::check_temperature("deploy", temperature);
        temperature_ = temperature;
    }
    /// 1, or the temperature of the model or file.
    [[nodiscard]] double temperature() const noexcept { return temperature_; }

    /// Sets how the counts of a frame are compressed. Throws std::invalid_argument for a knee that is not
    /// valid.
    void set_input_function(const input_function& function) {
        detail::check_input_function("deploy", function);
        function_ = function;
    }
    [[nodiscard]] const input_function& function() const noexcept { return function_; }

    /// Sets which reflections show a class, for `reflection_average`. Throws std::invalid_argument for
    /// partners that are not pairs of outputs.
    void set_reflections(reflection_rule rule) {
        detail::check_partners("deploy", rule, outputs);
        reflections_ = std::move(rule);
    }
    /// All, or those of the model or file.
    [[nodiscard]] const reflection_rule& reflections() const noexcept { return reflections_; }

    /// A view of these weights and reflections, which must outlive the view, and of the number of classes,
    /// the temperature and the input function as they are now.
    [[nodiscard]] view_type view() const& noexcept {
        return view_type(packed_.data(), class_count(), temperature_, function_, view_of(reflections_));
    }
    view_type view() const&& = delete;
    operator view_type() const& noexcept { return view(); }
    operator view_type() const&& = delete;
    /// The numbers before packing, for a file or a header.
    [[nodiscard]] std::span<const float, view_type::folded_elements> folded() const noexcept {
        return std::span<const float, view_type::folded_elements>(folded_.data(), folded_.size());
    }

    using detail::refused_calls<input_shape, outputs>::infer;
    using detail::refused_calls<input_shape, outputs>::classify;

    /// Writes the outputs of the network for a frame: logits, or whatever its last layer computes.
    frame_status infer(frame_ref<input_shape> frame, std::span<float, outputs> to,
                       workspace& memory) const noexcept {
        return view().infer(frame, to, memory);
    }
    frame_status infer(frame_ref<input_shape> frame, std::span<float, outputs> to) const noexcept {
        return view().infer(frame, to);
    }
    /// The class that a frame most likely shows; its name is a view of one of `classes()`. std::nullopt if
    /// the frame or its outputs are not finite.
    [[nodiscard]] std::optional<recognition> classify(frame_ref<input_shape> frame,
                                                      workspace& memory) const& noexcept {
        return with_name(view().classify(frame, memory));
    }
    [[nodiscard]] std::optional<recognition> classify(frame_ref<input_shape> frame) const& noexcept {
        return with_name(view().classify(frame));
    }

    /// What the last layer reads, as read_features of the view. A template, so that a network that cannot be
    /// lowered has no error for this, too.
    static constexpr std::size_t features = view_type::features;
    template <class View = view_type>
    void read_features(const workspace& memory, std::span<float, View::features> to) const noexcept {
        view().read_features(memory, to);
    }

    /// Writes the outputs of many frames, one row per frame, on all threads of a pool, bit-identical to
    /// running each frame alone. Returns `not_finite` if one of the frames is broken. Throws
    /// std::invalid_argument unless there is a row of outputs for each frame.
    ///
    /// A small network takes one frame after the other on each thread, or a few at a time if its weights
    /// exceed the second level of cache. A large one runs layer by layer over several frames, with all
    /// threads on each layer, for a single frame too. If the workspace exceeds the stack, it is taken from
    /// the heap, unless you keep `memory` from call to call.
    frame_status infer(const frames_ref<input_shape>& frames, std::span<float> to, thread_pool& pool,
                       batch_workspace& memory) const {
        return detail::batch_inference<view_type>::run(view(), frames, to, pool, memory);
    }
    frame_status infer(const frames_ref<input_shape>& frames, std::span<float> to, thread_pool& pool) const {
        batch_workspace memory;
        return infer(frames, to, pool, memory);
    }
    /// Returns the class that each frame most likely shows, or std::nullopt for a broken one. Throws
    /// std::invalid_argument if a frame is cut short.
    [[nodiscard]] std::vector<std::optional<recognition>>
    classify(const frames_ref<input_shape>& frames, thread_pool& pool, batch_workspace& memory) const& {
        std::vector<float> found(frames.size() * outputs);
        std::vector<frame_status> status(frames.size(), frame_status::ok);
        (void)detail::batch_inference<view_type>::run(view(), frames, found, pool, memory, status.data());
        std::vector<std::optional<recognition>> result(frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i)
            if (status[i] == frame_status::ok)
                result[i] = with_name(
                    view().classify_outputs(std::span(found).subspan(i * outputs).template first<outputs>()));
        return result;
    }
    [[nodiscard]] std::vector<std::optional<recognition>> classify(const frames_ref<input_shape>& frames,
                                                                   thread_pool& pool) const& {
        batch_workspace memory;
        return classify(frames, pool, memory);
    }
    /// The names of a temporary would not outlive the call.
    template <class... Arguments>
    std::optional<recognition> classify(Arguments&&...) const&& = delete;

private:
    static constexpr float largest_parameter = 1e30f;

    /// Sets the largest magnitude of the input, a power of ten, with which no sum can overflow, whatever the
    /// signs. If that would reject counts of 8 bits, as in a very deep network, only NaN and infinity are
    /// rejected.
    void set_limit() {
        constexpr double most = static_cast<double>(std::numeric_limits<float>::max()) /
                                kernels::frame_method::max_intermediate_growth;
        double largest = 1e36, needed = 0;
        for (std::size_t e = 0; e < input_shape.size(); ++e)
            for (const double count : {0.0, 255.0})
                needed = std::max(needed, std::abs((count - static_cast<double>(folded_[e])) *
                                                   static_cast<double>(folded_[input_shape.size()])));
        while (largest >= needed &&
               !(lowered::step::output_bound(folded_.data() + view_type::steps_folded, largest) <= most))
            largest /= 10;
        folded_[input_shape.size() + 1] =
            largest >= needed ? static_cast<float>(largest) : std::numeric_limits<float>::max();
    }

    [[nodiscard]] std::optional<recognition> with_name(std::optional<recognition> found) const noexcept {
        if (found && !classes_.empty())
            found->name = classes_[found->index];
        return found;
    }

    aligned_vector<float> folded_;
    detail::weight_vector<typename Format::packed_number> packed_;
    std::vector<std::string> classes_;
    double temperature_ = 1;
    input_function function_;
    reflection_rule reflections_ = reflection_rule::all();
};

/// Turns a trained network into its fastest form, for inputs (count − mean) × scale. Takes any list of layers
/// that can be deployed. Throws as the constructor of `deployed`.
template <class Network>
[[nodiscard]] deployed<Network>
deploy(const Network& network, std::span<const float, Network::input_shape.size()> mean, float scale = 1) {
    return deployed<Network>(network, mean, scale);
}
/// As above, for inputs without normalisation.
template <class Network>
[[nodiscard]] deployed<Network> deploy(const Network& network) {
    // On the heap: the photographs of large networks take more than half a megabyte.
    const std::vector<float> zero(Network::input_shape.size());
    return deployed<Network>(network, std::span(zero).template first<Network::input_shape.size()>(), 1);
}
/// A trained network with its normalisation and the names of its classes, as `load_model` returns it. Throws
/// std::invalid_argument as the constructor of `deployed`.
template <class Network>
[[nodiscard]] deployed<Network> deploy(const model<Network>& trained) {
    return deployed<Network>(trained);
}

}} // namespace tactnet
