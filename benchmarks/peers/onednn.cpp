#include "onednn_steps.hpp"

namespace benchmark {

namespace {

class onednn final : public onednn_steps<peer, float> {
public:
    onednn(const described_network& network, std::size_t batch, std::size_t threads)
        : onednn_steps(network, batch, threads, type::f32) {
        for (const operation& o : network.operations())
            switch (o.what) {
            case operation::kind::convolution:
                add_convolution(o);
                break;
            case operation::kind::pool:
            case operation::kind::average:
                add_pool(o);
                break;
            case operation::kind::relu:
                add_relu(o);
                break;
            case operation::kind::concatenation:
                add_concatenation(o);
                break;
            case operation::kind::dense:
                add_dense(o);
                break;
            }
        const std::size_t last = network.operations().back().output;
        const tactnet::shape out = network.maps()[last];
        result_ = as(last, is_flat(last)
                               ? dnnl::memory::desc({number(batch), number(out.channels)}, type::f32, tag::nc)
                               : dnnl::memory::desc(shape_of(out), type::f32, tag::nchw));
        stream_.wait();
    }

private:
    static constexpr types floats{type::f32, type::f32, type::f32, type::f32};

    void add_convolution(const operation& o) {
        const auto chosen = convolution(o, floats, attributes_of(o, 1, type::undef));
        // The sum is taken in place, so the other term must be in the convolution's layout.
        maps_[o.output] =
            o.accumulates ? as(o.output, chosen.dst_desc()) : dnnl::memory(chosen.dst_desc(), engine_);
        add_layer<dnnl::convolution_forward>(chosen, o, {kernel_of(o), type::f32, tag::oihw}, o.weights,
                                             o.bias);
    }

    void add_relu(const operation& o) {
        const dnnl::memory in = maps_[o.input];
        const dnnl::eltwise_forward::desc description(
            dnnl::prop_kind::forward_inference, dnnl::algorithm::eltwise_relu, in.get_desc(), 0.0f, 0.0f);
        maps_[o.output] = dnnl::memory(in.get_desc(), engine_);
        add(dnnl::eltwise_forward({description, engine_}),
            {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, maps_[o.output]}});
    }

    void add_dense(const operation& o) {
        dims kernel{number(o.to.channels), number(o.from.channels)};
        const bool flat = is_flat(o.input);
        if (!flat)
            kernel.insert(kernel.end(), {number(o.from.rows), number(o.from.columns)});
        const auto chosen = dense(o, kernel, floats, {});
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        add_layer<dnnl::inner_product_forward>(chosen, o, {kernel, type::f32, flat ? tag::ab : tag::oihw},
                                               o.weights, o.bias);
    }

    /// Behind a dense layer maps have lost their rows and columns.
    [[nodiscard]] bool is_flat(std::size_t map) const { return maps_[map].get_desc().dims().size() == 2; }
};

} // namespace

std::unique_ptr<peer> make_onednn(const described_network& network, std::size_t batch, std::size_t threads) {
    return std::make_unique<onednn>(network, batch, threads);
}

} // namespace benchmark
