#include <tactnet/quantisation.hpp>
#include <tactnet/tactnet.hpp>

using namespace tactnet;

#ifdef CASE_fused_function_of_one_width
// expect: activation: a function that says works_on_vectors takes vectors of every width, so that value is a template
struct of_widest_vectors {
    static constexpr const char *name = "own", *title = "Own", *type = "of_widest_vectors", *header = "";
    static constexpr bool works_on_vectors = true;
    using number = kernels::vector<float>;
    static number value(const number& x) { return x + x; }
    static double value(double x) { return 2 * x; }
    static number backward(const number&, const number& gradient) { return gradient + gradient; }
};

using net = network<shape{5, 4, 1}, conv2d<2, 3>, activation<of_widest_vectors>, dense<3>>;
auto deployed = deploy(net{});
// Where vectors have one width, the function is as it should be, and nothing is left to test.
static_assert(
    kernels::lanes<float> > kernels::min_lanes<float>,
    "activation: a function that says works_on_vectors takes vectors of every width, so that value is "
    "a template");

#elif defined(CASE_fused_function_that_moves_zero)
// expect: convolution_step: a function that is not zero at zero needs filters that fill all lanes
constexpr kernels::frame_convolution convolution{.window =
                                                     sliding_window::over({5, 4, 16}, 3, 1, padding::same),
                                                 .filters = 5,
                                                 .input_stride = 16,
                                                 .activation = fused<sigmoid_function>};
constexpr auto elements = convolution_step<single_precision, convolution>::folded_elements;

#elif defined(CASE_relu_with_an_upper_bound)
// expect: activation: is_relu is true for a ReLU alone, and this function has other values
struct bounded_relu_function : relu_function {
    template <class T>
    static constexpr T value(T x) {
        return x < 0 ? T(0) : x < 6 ? x : T(6);
    }
};

using net = network<shape{5, 4, 1}, conv2d<2, 3>, activation<bounded_relu_function>, dense<3>>;
auto deployed = deploy(net{});

#elif defined(CASE_eight_bits_without_images)
// expect: deploy<eight_bit>: pass training images after the model: they set the activation ranges
// at-most: 2
using net = network<shape{5, 4, 1}, conv2d<2, 3>, dense<3>>;
const auto made = deploy<eight_bit>(model<net>{});

#elif defined(CASE_residual_does_nothing)
// expect: deploy: the main branch of a residual block must do something in inference
// characters: 30000
using net = network<shape{28, 50}, conv2d<8, 5>, residual<dropout<50>>, dense<22>>;
const auto made = deploy(net{});

#elif defined(CASE_sequences_as_frames)
// expect: deploy: a network of sequences runs frame by frame: use deploy_stream
using net = network<shape{20, 1, 3}, gru<8>, last_frame, dense<3>>;
const auto made = deploy(net{});

#elif defined(CASE_stream_looks_back_after_the_last_frame)
// expect: deploy_stream: after last_frame, layers have one frame of each sequence: gru, lstm and causal_conv1d of several taps must come before it
using net = network<shape{20, 1, 3}, gru<8>, last_frame, sequence<dense<4>, gru<4>>, dense<2>>;
constexpr std::size_t bytes = deployed_stream<net>::weight_bytes;

#elif defined(CASE_stream_looks_back_after_a_block)
// expect: deploy_stream: after last_frame, layers have one frame of each sequence
using net = network<shape{20, 1, 3}, gru<8>, residual<sequence<last_frame, dense<8>>, last_frame>, gru<4>>;
constexpr std::size_t bytes = deployed_stream<net>::weight_bytes;

#elif defined(CASE_stream_view_of_temporary)
// expect: deleted
using net = network<shape{20, 1, 3}, gru<8>, last_frame, dense<2>>;
const auto view = deploy_stream(net{}).view();

#elif defined(CASE_stream_of_all_frames)
// expect: deploy_stream: this layer does not run frame by frame; runs_in_streams shows it and its input
// expect: dense<3
using net = network<shape{20, 1, 3}, gru<8>, dense<3>>;
const auto made = deploy_stream(net{});

#elif defined(CASE_unknown_layer)
// expect: deploy: a layer of this kind has no lowering; has_lowering shows it
// expect: doubling
struct doubling : relu {};

using net = network<shape{5, 4, 1}, conv2d<2, 3>, doubling, dense<3>>;
auto deployed = deploy(net{});

#elif defined(CASE_workspace_too_large_for_stack)
// expect: deployed: this network needs more workspace than a stack should hold: give it some from the heap; fits_stack shows bytes needed, bytes at most
using net = network<shape{200, 200}, conv2d<16, 1>, dense<1>>;

bool recognise(const deployed<net>& fast, tensor_view<const float, net::input_shape> frame,
               std::span<float, 1> to) {
    return fast.infer(frame, to) == frame_status::ok;
}

#elif defined(CASE_eight_bit_step_without_reference)
// expect: deploy: in 8 bits each step needs a function `reference` for calibration
struct mute_step : step_base<eight_bit, shape{1, 2}, 2> {};
template <>
struct tactnet::step_description<mute_step> {
    static constexpr void visit(auto&& to) { to("mute_step", "Mute", std::type_identity<eight_bit>{}); }
};
const std::size_t map = detail::graph_builder({1, 2}, 0).append<mute_step>(0);

#elif defined(CASE_eight_bit_average_pool_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 2
using net = network<shape{8, 8}, average_pool<2>, conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_dilated_conv2d_first)
// expect: in this number format a network cannot begin with a dilated convolution: a convolution, a dense layer or a batch norm must come first
using net = network<shape{8, 8}, dilated_conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_gate_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 4
using net = network<shape{4, 4, 2}, squeeze_excitation<2, 1>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_group_norm_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 2
using net = network<shape{8, 8, 2}, group_norm<2>, conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_local_response_norm_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 2
using net = network<shape{8, 8, 2}, local_response_norm<>, conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_local_response_norm_last)
// expect: in this number format a network must end in a convolution, a dense layer or an average pool
// at-most: 3
using net = network<shape{8, 8, 2}, conv2d<4, 3>, local_response_norm<>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_local_response_norm_of_other_powers)
// expect: local_response_norm: in 8 bits beta must be 1/2, 3/4 or 1; exponent_of_roots shows it
// at-most: 2
using other = local_response_norm<5, std::ratio<1>, std::ratio<4, 5>>;
using net = network<shape{8, 8, 2}, conv2d<4, 3>, other, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_local_response_norm_too_wide)
// expect: local_response_norm: in 8 bits a window holds at most 258 channels
// at-most: 2
using net = network<shape{8, 8, 2}, conv2d<4, 3>, local_response_norm<259>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_pool_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 2
using net = network<shape{8, 8}, max_pool<2>, conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_relu_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 2
using net = network<shape{8, 8}, relu, conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_residual_first)
// expect: in this number format a network cannot begin with a residual block that passes its input on
// at-most: 3
using net = network<shape{4, 4, 2}, residual<sequence<conv2d<2, 3>>>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_sequences)
// expect: deploy: a network of sequences runs frame by frame: use deploy_stream
using net = network<shape{20, 1, 3}, gru<8>, last_frame, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_softmax_within)
// expect: in this number format a softmax must be the last layer
// at-most: 2
using net = network<shape{8, 8}, conv2d<4, 3>, softmax, dense<2>>;
frame_status recognise(const deployed<net, eight_bit>& deployed,
                       tensor_view<const float, net::input_shape> frame,
                       std::span<float, net::outputs> logits) {
    return deployed.infer(frame, logits);
}

#elif defined(CASE_eight_bit_stream_activation_first)
// expect: deploy_stream: in 8 bits this layer does not run frame by frame here; runs_in_streams shows it, its input and the format of numbers. The first layer reads words of 16 bits: it must be gru, lstm, causal_conv1d or dense
// at-most: 2
using net = network<shape{20, 1, 3}, hyperbolic_tangent, gru<8>, last_frame, dense<2>>;
constexpr std::size_t bytes = deployed_stream<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_stream_of_all_frames)
// expect: deploy_stream: in 8 bits this layer does not run frame by frame here; runs_in_streams shows it
// expect: dense<3
// at-most: 2
using net = network<shape{20, 1, 3}, gru<8>, dense<3>>;
constexpr std::size_t bytes = deployed_stream<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_stream_without_weights)
// expect: deploy_stream: the network needs a layer with weights
// at-most: 2
using net = network<shape{20, 1, 3}, last_frame>;
constexpr std::size_t bytes = deployed_stream<net, eight_bit>::weight_bytes;

#elif defined(CASE_eight_bit_upsample_first)
// expect: in 8 bits a network cannot begin with a pool, an upsampling, an activation or a group, instance, layer or local response norm: a convolution, a dense layer or a batch norm
// at-most: 2
using net = network<shape{8, 8}, upsample<2>, conv2d<4, 3>, dense<2>>;
constexpr std::size_t bytes = deployed<net, eight_bit>::weight_bytes;

#elif defined(CASE_pool_without_its_header)
// expect: deployed: to pass a thread_pool, include tactnet/runtime/thread_pool.hpp
// at-most: 3
auto classify(const deployed<network<shape{8, 8}, dense<2>>>& fast, std::span<const std::uint8_t> frames,
              thread_pool& pool) {
    return fast.classify(frames, pool);
}
#endif
