#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>
#include <tactnet/runtime/work_share.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Runs everything on the calling thread, for at most so many frames: the place of a thread_pool.
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

/// Runs steps layer by layer over several frames, on the threads of a pool: a thread_pool or an
/// inline_executor. The maps of the frames lie one after the other, each in whole cache lines. There is
/// memory for as many frames or threads as there are, whichever are more. No bit depends on either number.
///
/// A step with `run_share` says what one thread does of it; one with `run_batch` takes several frames at
/// once, or has steps inside it. Others run frame by frame.
template <class Pool>
struct batch_executor {
    Pool& pool;
    std::size_t frames;

    /// Frames that there are at most.
    static constexpr std::size_t most_frames = [] {
        if constexpr (requires { Pool::most_frames; })
            return Pool::most_frames;
        else
            return std::numeric_limits<std::size_t>::max();
    }();

    [[nodiscard]] std::size_t threads() const { return pool.threads(); }
    /// How many times the memory holds what one call needs.
    [[nodiscard]] std::size_t copies() const { return std::max(frames, threads()); }
    /// body(frame) for all of them.
    template <class Body>
    void for_each_frame(const Body& body) const {
        pool.for_each(frames, body);
    }
};

namespace detail {

/// Elements from the map that a step writes to that of the next frame.
template <class Step>
inline constexpr std::size_t
    map_distance = whole_lines<typename Step::format::activation>(Step::output.area() * Step::output_stride *
                                                                  number_elements<Step>);

/// Whether a step has large ones in it, which frames and threads had better pass together.
template <class Step>
inline constexpr bool is_large = [] {
    if constexpr (requires { Step::large; })
        return Step::large;
    else
        return false;
}();

template <class Step, class Executor>
void run_batch(const typename Step::format::packed* packed, const typename Step::format::activation* in,
               std::size_t in_distance, typename Step::format::activation* out,
               typename Step::format::activation* memory, const Executor& executor) {
    static_assert(Step::workspace_elements ==
                      whole_lines<typename Step::format::activation>(Step::workspace_elements),
                  "a step's workspace must be whole cache lines, so that the next frame's is aligned");
    if constexpr (requires { Step::run_batch(packed, in, in_distance, out, memory, executor); }) {
        Step::run_batch(packed, in, in_distance, out, memory, executor);
    } else if constexpr (requires { Step::run_share(packed, in, out, memory, kernels::large_job{}); }) {
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
} // namespace TACTNET_ARCH
} // namespace tactnet
