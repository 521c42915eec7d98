#include <tactnet/tactnet.hpp>

#ifdef CASE_relu_with_an_upper_bound
// expect: activation: is_relu is true for a ReLU alone, and this function has other values
// at-most: 1
struct relu6_function : tactnet::relu_function {
    template <class T>
    static constexpr T value(T x) {
        return x < 0 ? T(0) : x < 6 ? x : T(6);
    }
};

using net = tactnet::network<tactnet::shape{5, 4, 1}, tactnet::conv2d<2, 3>,
                             tactnet::activation<relu6_function>, tactnet::dense<3>>;
auto deployed = tactnet::deploy(net{});
#endif

#ifdef CASE_residual_ends_in_relu
// expect: deploy: the main branch of a residual block must end in a convolution, with or without batch norm
// at-most: 1
// characters: 30000
using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>,
                             tactnet::residual<tactnet::sequence<tactnet::conv2d<8, 3>, tactnet::relu>>,
                             tactnet::dense<22>>;
const auto made = tactnet::deploy(net{});
#endif

#ifdef CASE_sequences_as_frames
// expect: deploy: a network of sequences runs frame by frame, in single precision: use deploy_stream
// at-most: 1
using net =
    tactnet::network<tactnet::shape{20, 1, 3}, tactnet::gru<8>, tactnet::last_frame, tactnet::dense<3>>;
const auto made = tactnet::deploy(net{});
#endif

#ifdef CASE_stream_of_all_frames
// expect: deploy_stream: this layer does not run frame by frame; runs_in_streams shows it and its input
// expect: dense<3
// at-most: 1
using net = tactnet::network<tactnet::shape{20, 1, 3}, tactnet::gru<8>, tactnet::dense<3>>;
const auto made = tactnet::deploy_stream(net{});
#endif

#ifdef CASE_unknown_layer
// expect: deploy: a layer of this kind has no lowering; has_lowering shows it
// expect: doubling
// at-most: 1
struct doubling : tactnet::relu {};

using net = tactnet::network<tactnet::shape{5, 4, 1}, tactnet::conv2d<2, 3>, doubling, tactnet::dense<3>>;
auto deployed = tactnet::deploy(net{});
#endif

#ifdef CASE_workspace_too_large_for_stack
// expect: deployed: this network needs more workspace than a stack should hold: give it some from the heap; fits_stack shows bytes needed, bytes at most
// at-most: 1
using net = tactnet::network<tactnet::shape{200, 200}, tactnet::conv2d<16, 1>, tactnet::dense<1>>;

bool recognise(const tactnet::deployed<net>& fast, tactnet::tensor_view<const float, net::input_shape> frame,
               std::span<float, 1> to) {
    return fast.infer(frame, to) == tactnet::frame_status::ok;
}
#endif
