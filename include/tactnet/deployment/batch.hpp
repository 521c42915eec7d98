#pragma once

#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <span>

// Inference of many frames on all threads of a pool. The bits are those of each frame alone.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A grow-only buffer for calls with many frames. Keep it from call to call, of any network, so that only the
/// first call allocates. It serves one call at a time.
class batch_workspace {
public:
    batch_workspace() = default;
    batch_workspace(const batch_workspace&) = delete;
    batch_workspace& operator=(const batch_workspace&) = delete;
    ~batch_workspace() { release(); }

    /// Memory for `elements` elements, aligned to `vector_alignment` and not initialised: pages that no call
    /// touches cost nothing.
    template <class T>
    [[nodiscard]] T* hold(std::size_t elements) {
        const std::size_t bytes = elements * sizeof(T);
        if (bytes > held_.size()) {
            release();
            held_ = {aligned_allocator<std::byte>().allocate(bytes), bytes};
        }
        return static_cast<T*>(static_cast<void*>(held_.data()));
    }

private:
    void release() noexcept {
        if (!held_.empty())
            aligned_allocator<std::byte>().deallocate(held_.data(), held_.size());
        held_ = {};
    }
    std::span<std::byte> held_;
};

namespace detail {

/// Runs frames through a deployed_view, a few at a time.
template <class View>
struct batch_inference {
    using activation = typename View::activation;
    using frames_type = frames_ref<View::input_shape>;
    static constexpr std::size_t pixels = View::input_shape.size(), outputs = View::outputs;

    /// Frames at a time through a large network, if there are not more threads. Weights are read once for all
    /// of them, but their maps evict each other from the caches. Hence the weights divided by the workspace
    /// of a frame, from 1 to 16.
    static constexpr std::size_t max_on_all_threads =
        std::clamp<std::size_t>(detail::ceil_div(View::weight_bytes, View::workspace_bytes), 1, 16);
    /// Bytes of stack for a smaller network. Threads have a quarter of a megabyte on most systems, and that
    /// stays in the second level of cache. More pays only if the weights outgrow that level.
    static constexpr std::size_t max_memory =
        View::weight_bytes > kernels::l2_cache_bytes ? View::max_stack_bytes : std::size_t{256} * 1024;
    /// Frames at a time through a smaller network on each thread, layer by layer: weights then come from a
    /// nearer cache, or are read once for all frames.
    static constexpr std::size_t on_one_thread =
        std::clamp<std::size_t>(max_memory / (View::workspace_elements * sizeof(activation)), 1, 4);
    static constexpr bool on_stack = View::workspace_bytes <= View::max_stack_bytes;

    /// `status` is null, or has one element per frame; those of broken frames become not_finite. Throws
    /// std::invalid_argument unless there is a row of outputs for each frame. `Pool` is
    /// thread_pool, a parameter so that programs without threads need not include its header.
    template <class Pool>
    static frame_status run(const View& view, const frames_type& frames, std::span<float> to, Pool& pool,
                            batch_workspace& memory, frame_status* status = nullptr) {
        static_assert(
            requires { sizeof(Pool); },
            "deployed: to pass a thread_pool, include tactnet/runtime/thread_pool.hpp");
        const std::size_t count = frames.size();
        if (count * pixels != frames.elements() || count * outputs != to.size())
            detail::throw_invalid_argument({"deployed: expected frames of ", pixels, " counts and ", outputs,
                                            " outputs for each, found ", frames.elements(), " counts and ",
                                            to.size(), " outputs"});
        const auto infer = [&](std::size_t first, activation* thread_memory, const auto& executor) {
            return view.infer_batch(frames, first, to.data() + first * outputs, thread_memory, executor,
                                    status == nullptr ? nullptr : status + first);
        };
        std::atomic<bool> in_range = true;
        if constexpr (View::layerwise) {
            const std::size_t group = std::max(max_on_all_threads, pool.threads());
            for (std::size_t first = 0; first < count; first += group) {
                const batch_executor<Pool> executor{pool, std::min(group, count - first)};
                if (infer(first, memory.hold<activation>(executor.copies() * View::workspace_elements),
                          executor) != frame_status::ok)
                    in_range = false;
            }
        } else {
            const std::size_t shares = std::min(pool.threads(), count); // one frame wakes no other thread
            activation* const heap =
                on_stack ? nullptr : memory.hold<activation>(shares * View::workspace_elements);
            pool.for_each(shares, [&](std::size_t index) {
                const work_share share{index, shares};
                alignas(vector_alignment)
                    std::array<activation, on_stack ? on_one_thread * View::workspace_elements : 1>
                        stack_memory; // not zeroed
                activation* const thread_memory =
                    on_stack ? stack_memory.data() : heap + index * View::workspace_elements;
                inline_executor<on_one_thread> here;
                const std::size_t end = share.end(count);
                for (std::size_t first = share.begin(count); first < end; first += on_one_thread) {
                    const batch_executor<inline_executor<on_one_thread>> executor{
                        here, std::min(on_one_thread, end - first)};
                    if (infer(first, thread_memory, executor) != frame_status::ok)
                        in_range = false;
                }
            });
        }
        return in_range ? frame_status::ok : frame_status::not_finite;
    }
};

} // namespace detail
}} // namespace tactnet
