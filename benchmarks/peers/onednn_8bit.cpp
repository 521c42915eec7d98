#include "../support/whole_numbers.hpp"
#include "onednn_steps.hpp"

#include <cstdint>
#include <stdexcept>

// oneDNN's own primitives in 8 bits: bytes without a sign times bytes with one, a scale for each filter, sums
// of 32 bits.

namespace benchmark {

namespace {

class onednn_8bit final : public onednn_steps<byte_peer, std::uint8_t> {
public:
    onednn_8bit(const described_network& network, std::size_t batch, std::span<const std::uint8_t> frames)
        : onednn_steps(network, batch, 1, type::u8), scales_(network.maps().size(), 1) {
        const ranges seen(network, frames);
        const operation& end = network.operations().back();
        for (const operation& o : network.operations())
            if (o.what == operation::kind::pool || o.what == operation::kind::average) {
                scales_[o.output] = scales_[o.input];
                add_pool(o);
            } else if (o.what == operation::kind::concatenation) {
                scales_[o.output] = scales_[o.inputs.front()];
                add_concatenation(o);
            } else if (o.what == operation::kind::dense) {
                add_dense(o, &o == &end);
            } else {
                add_convolution(o, seen.largest[o.output],
                                end.what == operation::kind::average && end.input == o.output);
            }
        result_ = maps_[end.output];
        stream_.wait();
    }

private:
    [[nodiscard]] type type_of(std::size_t map) const { return maps_[map].get_desc().data_type(); }

    /// `floats`: writes floats, for an average pool at the end.
    void add_convolution(const operation& o, float largest, bool floats) {
        const type output = floats ? type::f32 : o.relu ? type::u8 : type::s8;
        const float output_scale = floats ? 1 : largest / (o.relu ? 255.0f : 127.0f);
        const whole_numbers whole = quantised(o, scales_[o.input]);
        std::vector<float> factors = whole.units;
        for (float& factor : factors)
            factor /= output_scale;
        dnnl::primitive_attr attributes = attributes_of(o, scales_[o.output] / output_scale,
                                                        o.accumulates ? type_of(o.output) : type::undef);
        attributes.set_output_scales(1 << 1, factors);
        const auto chosen = convolution(o, {type_of(o.input), type::s8, type::s32, output}, attributes);
        if (o.accumulates) {
            // Taken in place, in the layout of the output; its bytes may have another sign.
            dnnl::memory::desc wanted = chosen.dst_desc();
            wanted.data.data_type = static_cast<dnnl_data_type_t>(type_of(o.output));
            const dnnl::memory term = as(o.output, wanted);
            maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_, term.get_data_handle());
            kept_.push_back(term);
        } else {
            maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        }
        scales_[o.output] = output_scale;
        add_layer<dnnl::convolution_forward>(chosen, o, {kernel_of(o), type::s8, tag::oihw}, whole.weights,
                                             whole.bias);
    }
    void add_dense(const operation& o, bool last) {
        if (!last)
            throw std::invalid_argument("onednn_8bit: expected one dense layer, the last");
        const dims kernel{number(o.to.channels), number(o.from.channels), number(o.from.rows),
                          number(o.from.columns)};
        const whole_numbers whole = quantised(o, scales_[o.input]);
        dnnl::primitive_attr attributes;
        attributes.set_output_scales(1 << 1, whole.units);
        const auto chosen = dense(o, kernel, {type_of(o.input), type::s8, type::s32, type::f32}, attributes);
        maps_[o.output] = dnnl::memory(chosen.dst_desc(), engine_);
        add_layer<dnnl::inner_product_forward>(chosen, o, {kernel, type::s8, tag::oihw}, whole.weights,
                                               whole.bias);
    }

    std::vector<dnnl::memory> kept_;
    std::vector<float> scales_; ///< what one step of each map's bytes is worth
};

} // namespace

std::unique_ptr<byte_peer> make_onednn_8bit(const described_network& network, std::size_t batch,
                                            std::span<const std::uint8_t> frames) {
    return std::make_unique<onednn_8bit>(network, batch, frames);
}

} // namespace benchmark
