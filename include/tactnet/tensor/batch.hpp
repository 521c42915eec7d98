#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

// Interleaved samples. `Lanes` samples form a lane block, ordered [channel][row][column][lane]: one vector
// register holds the same element of `Lanes` samples. A kernel written for one sample then runs on all lanes
// at once, at any image size and channel count, without a remainder and without a sum across lanes in the
// forward pass; a sample's result does not depend on its neighbours. Lanes after the last sample hold zeros
// in inputs and in gradients, on which sums over a batch rely; between layers their values are meaningless.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A view of a batch: whole lane blocks that belong to the caller, aligned to 64 bytes. T may be const.
template <class T, shape Shape, std::size_t Lanes>
class batch_view {
public:
    static constexpr shape extents = Shape;
    static constexpr std::size_t lanes = Lanes;
    static constexpr std::size_t lane_block_size = Shape.size() * Lanes;

    constexpr batch_view(T* data, std::size_t samples) : data_(data), samples_(samples) {}
    constexpr batch_view(const batch_view<std::remove_const_t<T>, Shape, Lanes>& other)
        requires std::is_const_v<T>
        : data_(other.data()), samples_(other.samples()) {}
    constexpr batch_view(const batch_view&) = default;
    constexpr batch_view& operator=(const batch_view&) = default;

    [[nodiscard]] constexpr T* data() const { return data_; }
    [[nodiscard]] constexpr std::size_t samples() const { return samples_; }
    [[nodiscard]] constexpr std::size_t lane_blocks() const { return detail::ceil_div(samples_, Lanes); }
    [[nodiscard]] constexpr T* lane_block(std::size_t index) const { return data_ + index * lane_block_size; }
    /// The number of samples in one lane block: `Lanes`, or fewer in the last.
    [[nodiscard]] constexpr std::size_t samples_in(std::size_t block) const {
        return std::min(Lanes, samples_ - block * Lanes);
    }
    /// A view of the lane blocks first … last − 1; a part of a null view is a null view.
    [[nodiscard]] constexpr batch_view part(std::size_t first, std::size_t last) const {
        return {data_ ? lane_block(first) : nullptr, std::min(samples_, last * Lanes) - first * Lanes};
    }
    [[nodiscard]] constexpr T& operator()(std::size_t sample, std::size_t element) const {
        return lane_block(sample / Lanes)[element * Lanes + sample % Lanes];
    }

private:
    T* data_;
    std::size_t samples_;
};

/// A batch that owns its samples.
template <class T, shape Shape, std::size_t Lanes>
class batch {
public:
    using view_type = batch_view<T, Shape, Lanes>;
    using const_view_type = batch_view<const T, Shape, Lanes>;

    batch() = default;
    explicit batch(std::size_t samples) { resize(samples); }

    /// Resizes and sets all elements to zero. Keeps its memory when it shrinks.
    void resize(std::size_t samples) {
        samples_ = samples;
        elements_.assign(detail::ceil_div(samples, Lanes) * view_type::lane_block_size, T{});
    }
    [[nodiscard]] std::size_t samples() const { return samples_; }
    [[nodiscard]] view_type view() { return {elements_.data(), samples_}; }
    [[nodiscard]] const_view_type view() const { return {elements_.data(), samples_}; }
    [[nodiscard]] const_view_type as_const() const { return view(); }
    operator view_type() { return view(); }
    operator const_view_type() const { return view(); }

    [[nodiscard]] T& operator()(std::size_t sample, std::size_t element) { return view()(sample, element); }
    [[nodiscard]] const T& operator()(std::size_t sample, std::size_t element) const {
        return view()(sample, element);
    }
    void set(std::size_t sample, tensor_view<const T, Shape> values) {
        for (std::size_t e = 0; e < Shape.size(); ++e)
            (*this)(sample, e) = values.data()[e];
    }
    void get(std::size_t sample, tensor_view<T, Shape> values) const {
        for (std::size_t e = 0; e < Shape.size(); ++e)
            values.data()[e] = (*this)(sample, e);
    }

private:
    aligned_vector<T> elements_;
    std::size_t samples_ = 0;
};

}} // namespace tactnet
