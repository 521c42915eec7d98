#pragma once

#include <tactnet/deployment/frame_status.hpp>
#include <tactnet/deployment/steps/batch_executor.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/runtime/work_share.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/alignment.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// Many frames through a deployed network, on all threads of a pool: each with the bits that it has alone.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// Memory that grows to what a call needs, and is kept for the next. It serves one call at a time.
template <class T>
class workspace_buffer {
public:
    workspace_buffer() = default;
    workspace_buffer(const workspace_buffer&) = delete;
    workspace_buffer& operator=(const workspace_buffer&) = delete;
    ~workspace_buffer() { release(); }

    /// Not written to: pages that no call touches cost nothing.
    T* hold(std::size_t elements) {
        if (elements > held_.size()) {
            release();
            held_ = {aligned_allocator<T>().allocate(elements), elements};
        }
        return held_.data();
    }

private:
    void release() noexcept {
        if (!held_.empty())
            aligned_allocator<T>().deallocate(held_.data(), held_.size());
        held_ = {};
    }
    std::span<T> held_;
};

/// A pool that is the thread which asks, for at most so many frames.
template <std::size_t MostFrames>
struct inline_executor {
    static constexpr std::size_t most_frames = MostFrames;
    static constexpr std::size_t threads() { return 1; }
    template <class Body>
    void on_each_thread(const Body& body) const {
        body(work_share{0, 1});
    }
    template <class Body>
    void for_each(std::size_t count, const Body& body) const {
        for (std::size_t i = 0; i < count; ++i)
            body(i);
    }
};

/// How many frames of such a network go through it. `View` is a deployed_view.
template <class View>
struct frame_batch {
    using memory_type = workspace_buffer<typename View::activation>;
    static constexpr std::size_t pixels = View::input_shape.size(), outputs = View::outputs;

    /// Frames of a large network that pass together at most, beyond one for each thread. Weights are read
    /// once for all of them, but their maps drive each other out of the caches: so many that the weights'
    /// share of a frame takes no more than its maps do, and no more than 16.
    static constexpr std::size_t most_on_all_threads = std::clamp<std::size_t>(
        (View::weight_bytes + View::workspace_bytes - 1) / View::workspace_bytes, 1, 16);
    /// Frames of a smaller one that pass together on one thread, layer by layer, so that weights which are
    /// read for each frame by itself come from nearer, or once for all of them: up to four, whose memory fits
    /// the stack. A quarter of a megabyte of it, which threads have on most systems and which stays in a
    /// second level of cache; more only where the weights outgrow that level.
    static constexpr std::size_t most_memory =
        View::weight_bytes > kernels::l2_cache_bytes ? View::most_on_stack : std::size_t{256} * 1024;
    static constexpr std::size_t on_one_thread = std::clamp<std::size_t>(
        most_memory / (View::workspace_elements * sizeof(typename View::activation)), 1, 4);

    /// Frames, if there is a row of outputs for each; else throws std::invalid_argument.
    static std::size_t checked_count(std::size_t counts, std::size_t numbers) {
        const std::size_t count = counts / pixels;
        if (count * pixels != counts || count * outputs != numbers)
            throw std::invalid_argument("deployed: expected frames of " + std::to_string(pixels) +
                                        " counts and " + std::to_string(outputs) +
                                        " outputs for each, found " + std::to_string(counts) +
                                        " counts and " + std::to_string(numbers) + " outputs");
        return count;
    }

    template <class Count>
    static frame_status recognise(const View& view, thread_pool& threads, std::span<const Count> frames,
                                  std::span<float> to) {
        if constexpr (View::large) {
            memory_type memory;
            return recognise(view, threads, frames, to, memory);
        } else if constexpr (View::workspace_bytes <= View::most_on_stack) {
            return a_few_together(view, threads, frames, to);
        } else {
            return from_the_heap(view, threads, frames, to);
        }
    }
    template <class Count>
    static frame_status recognise(const View& view, thread_pool& threads, std::span<const Count> frames,
                                  std::span<float> to, memory_type& memory) requires View::large {
        const std::size_t count = checked_count(frames.size(), to.size());
        const std::size_t group = std::max(most_on_all_threads, threads.threads());
        frame_status status = frame_status::ok;
        for (std::size_t first = 0; first < count; first += group) {
            const batch_executor<thread_pool> executor{threads, std::min(group, count - first)};
            if (view.infer_batch(frames.data() + first * pixels, to.data() + first * outputs,
                                 memory.hold(executor.copies() * View::workspace_elements),
                                 executor) != frame_status::ok)
                status = frame_status::not_finite;
        }
        return status;
    }

private:
    template <class Count>
    static frame_status a_few_together(const View& view, thread_pool& threads, std::span<const Count> frames,
                                       std::span<float> to) {
        const std::size_t count = checked_count(frames.size(), to.size());
        const std::size_t shares = std::min(threads.threads(), count); // one frame wakes no other thread
        std::atomic<bool> usual = true;
        threads.for_each(shares, [&](std::size_t index) {
            const work_share share{index, shares};
            alignas(alignment) std::array<typename View::activation, on_one_thread * View::workspace_elements>
                memory; // not zeroed
            inline_executor<on_one_thread> here;
            const std::size_t end = share.end(count);
            for (std::size_t first = share.begin(count); first < end; first += on_one_thread) {
                const batch_executor<inline_executor<on_one_thread>> executor{
                    here, std::min(on_one_thread, end - first)};
                if (view.infer_batch(frames.data() + first * pixels, to.data() + first * outputs,
                                     memory.data(), executor) != frame_status::ok)
                    usual = false;
            }
        });
        return usual ? frame_status::ok : frame_status::not_finite;
    }
    template <class Count>
    static frame_status from_the_heap(const View& view, thread_pool& threads, std::span<const Count> frames,
                                      std::span<float> to) {
        const std::size_t count = checked_count(frames.size(), to.size());
        std::atomic<bool> usual = true;
        using workspace = typename View::workspace;
        std::vector<std::unique_ptr<workspace>> memories(threads.threads());
        for (std::unique_ptr<workspace>& memory : memories)
            memory.reset(new workspace); // not zeroed, as by make_unique_for_overwrite, which libc++ 14 lacks
        threads.on_each_thread([&](work_share share) {
            for (std::size_t i = share.begin(count); i < share.end(count); ++i) {
                const tensor_view<const Count, View::input_shape> frame(frames.data() + i * pixels);
                if (view(frame, to.subspan(i * outputs).template first<outputs>(), *memories[share.index]) !=
                    frame_status::ok)
                    usual = false;
            }
        });
        return usual ? frame_status::ok : frame_status::not_finite;
    }
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
