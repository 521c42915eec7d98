#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Runs inline, on the calling thread, in place of a thread_pool. For at most `MostFrames` frames.
template <std::size_t MostFrames>
struct inline_executor {
    static constexpr std::size_t max_frames = MostFrames;
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

/// Runs steps layer by layer over several frames. `Pool` is a thread_pool or an inline_executor. The maps of
/// the frames lie one after the other, each in whole cache lines. The memory holds a workspace for each frame
/// or for each thread, whichever are more. The bits of the outputs depend on neither number.
template <class Pool>
struct batch_executor {
    Pool& pool;
    std::size_t frames;

    /// The largest possible number of frames.
    static constexpr std::size_t max_frames = [] {
        if constexpr (requires { Pool::max_frames; })
            return Pool::max_frames;
        else
            return std::numeric_limits<std::size_t>::max();
    }();

    [[nodiscard]] std::size_t threads() const { return pool.threads(); }
    /// How many workspaces the memory holds.
    [[nodiscard]] std::size_t copies() const { return std::max(frames, threads()); }
    /// Calls `body(frame)` for each frame.
    template <class Body>
    void for_each_frame(const Body& body) const {
        pool.for_each(frames, body);
    }
};

namespace detail {

/// Elements from the output map of one frame to that of the next.
template <class Step>
inline constexpr std::size_t map_distance = pad_to_cache_line<typename Step::format::activation>(
    Step::output.area() * Step::output_stride * Step::number_elements);

/// Runs one step over all frames of an executor: by its run_batch or run_share if it has one, otherwise frame
/// by frame.
template <class Step, class Executor>
void run_batch(const typename Step::format::packed_number* packed,
               const typename Step::format::activation* in, std::size_t in_distance,
               typename Step::format::activation* out, typename Step::format::activation* memory,
               const Executor& executor) {
    static_assert(
        Step::workspace_elements ==
            pad_to_cache_line<typename Step::format::activation>(Step::workspace_elements),
        "the workspace of a step must be whole cache lines, so that the one of the next frame is aligned");
    if constexpr (requires { Step::run_batch(packed, in, in_distance, out, memory, executor); }) {
        Step::run_batch(packed, in, in_distance, out, memory, executor);
    } else if constexpr (requires { Step::run_share(packed, in, out, memory, kernels::layerwise_job{}); }) {
        const std::size_t workspaces = executor.copies() / executor.threads();
        executor.pool.on_each_thread([&](work_share share) {
            Step::run_share(packed, in, out, memory + share.index * workspaces * Step::workspace_elements,
                            {executor.frames, in_distance, map_distance<Step>, share, workspaces});
        });
    } else {
        executor.for_each_frame([&](std::size_t frame) {
            Step::run(packed, in + frame * in_distance, out + frame * map_distance<Step>,
                      memory + frame * Step::workspace_elements);
        });
    }
}

} // namespace detail
}} // namespace tactnet
