#include <algorithm>
#include <cmath>
#include <optional>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/reference/layers.hpp>
#include <utility>

namespace support {

namespace {

/// Hands out the parts of a call's arrays, layer after layer.
class parts_of {
public:
    explicit parts_of(const reference_call& call) : left_(call) {}

    reference_call next(const reference_layer& layer) {
        reference_call part = left_;
        part.values = take(left_.values, layer.parameters);
        part.running = take(left_.running, layer.statistics);
        part.tiles = take(left_.tiles, left_.tiles.empty() ? 0 : layer.convolutions);
        return part;
    }

private:
    template <class T>
    static std::span<T> take(std::span<T>& from, std::size_t count) {
        if (count > from.size())
            throw std::logic_error("reference: the layers have more parameters than there are");
        const std::span<T> taken = from.first(count);
        from = from.subspan(count);
        return taken;
    }
    reference_call left_;
};

void add_costs(reference_layer& to, const reference_layer& from) {
    to.parameters += from.parameters;
    to.statistics += from.statistics;
    to.multiply_adds += from.multiply_adds;
    to.multiply_adds_on_pixels += from.multiply_adds_on_pixels;
    to.convolutions += from.convolutions;
}

/// One rounding of the sum.
void add(const reference_call& call, sample& to, const sample& skip) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        to[i] = {to[i].value + skip[i].value, to[i].error + skip[i].error,
                 std::hypot(to[i].deviation, skip[i].deviation)};
        to[i] = rounded_once(to[i], call.roundoff);
    }
}

class sequence final : public reference_layer {
public:
    sequence(extents3 size, std::vector<reference_pointer> layers) : layers_(std::move(layers)) {
        input = size;
        output = layers_.empty() ? size : layers_.back()->output;
        for (const reference_pointer& layer : layers_)
            add_costs(*this, *layer);
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples x = in;
        if (call.deployed) {
            for (sample& each : x)
                each = deployed(call, std::move(each), nullptr);
            return x;
        }
        parts_of parts(call);
        for (const reference_pointer& layer : layers_)
            x = layer->forward(parts.next(*layer), x);
        return x;
    }
    /// A batch norm or a channel scale is folded into a convolution of the same list, with no more than
    /// dropouts between them, and what is `added` goes into the sums of a convolution that stands last.
    [[nodiscard]] sample deployed(const reference_call& call, sample x, const sample* added) const {
        parts_of parts(call);
        for (std::size_t i = 0; i < layers_.size(); ++i) {
            const reference_call own = parts.next(*layers_[i]);
            const auto* taps = dynamic_cast<const folding_layer*>(layers_[i].get());
            if (taps == nullptr || !taps->folds() || !call.folded) {
                x = layers_[i]->forward(own, {x}).front();
                continue;
            }
            std::size_t behind = i + 1;
            while (behind < layers_.size() && dynamic_cast<const same_again*>(layers_[behind].get()))
                ++behind;
            std::optional<folded_norm> norm;
            if (behind < layers_.size()) {
                if (const auto* found = dynamic_cast<const batch_norm*>(layers_[behind].get()))
                    norm = found->folded(parts.next(*found)), i = behind;
                else if (const auto* scale = dynamic_cast<const channel_scale*>(layers_[behind].get()))
                    norm = scale->folded(parts.next(*scale)), i = behind;
            }
            const bool adds = i + 1 == layers_.size() && taps->adds();
            x = taps->deployed(own, x, norm, adds ? std::exchange(added, nullptr) : nullptr);
        }
        if (added != nullptr)
            add(call, x, *added);
        return x;
    }

private:
    std::vector<reference_pointer> layers_;
};

class residual final : public reference_layer {
public:
    residual(reference_pointer main, reference_pointer skip)
        : main_(std::move(main)), skip_(std::move(skip)) {
        input = main_->input;
        output = main_->output;
        add_costs(*this, *main_);
        add_costs(*this, *skip_);
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        parts_of parts(call);
        const reference_call main = parts.next(*main_), skip = parts.next(*skip_);
        samples sums = skip_->forward(skip, in);
        for (std::size_t s = 0; s < in.size() && call.deployed; ++s)
            sums[s] = dynamic_cast<const sequence&>(*main_).deployed(main, in[s], &sums[s]);
        if (call.deployed)
            return sums;
        const samples others = main_->forward(main, in);
        for (std::size_t s = 0; s < in.size(); ++s)
            add(call, sums[s], others[s]);
        return sums;
    }

private:
    reference_pointer main_, skip_;
};

/// Channels of all branches, one after the other.
class concatenation final : public reference_layer {
public:
    explicit concatenation(std::vector<reference_pointer> branches) : branches_(std::move(branches)) {
        input = branches_.front()->input;
        output = branches_.front()->output;
        output.channels = 0;
        for (const reference_pointer& branch : branches_) {
            output.channels += branch->output.channels;
            add_costs(*this, *branch);
        }
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples all(in.size());
        parts_of parts(call);
        for (const reference_pointer& branch : branches_) {
            const samples own = branch->forward(parts.next(*branch), in);
            for (std::size_t s = 0; s < in.size(); ++s)
                all[s].insert(all[s].end(), own[s].begin(), own[s].end());
        }
        return all;
    }

private:
    std::vector<reference_pointer> branches_;
};

/// Each channel times a factor that a branch gives; one rounding.
class gate final : public reference_layer {
public:
    explicit gate(reference_pointer branch) : branch_(std::move(branch)) {
        input = output = branch_->input;
        add_costs(*this, *branch_);
    }
    [[nodiscard]] samples forward(const reference_call& call, const samples& in) const override {
        samples out = in;
        const samples factors = branch_->forward(call, in);
        for (std::size_t s = 0; s < in.size(); ++s)
            for (std::size_t e = 0; e < input.size(); ++e) {
                const bounded x = in[s][e], factor = factors[s][e / input.area()];
                const bounded product{x.value * factor.value,
                                      magnitude(x) * factor.error + x.error * std::abs(factor.value),
                                      std::hypot(x.value * factor.deviation, x.deviation * factor.value)};
                out[s][e] = rounded_once(product, call.roundoff);
                out[s][e].error += lost;
            }
        return out;
    }

private:
    reference_pointer branch_;
};

} // namespace

reference_pointer reference_gate(reference_pointer branch) {
    return std::make_unique<gate>(std::move(branch));
}
reference_pointer reference_concatenation(std::vector<reference_pointer> branches) {
    return std::make_unique<concatenation>(std::move(branches));
}
reference_pointer reference_identity(extents3 input) {
    return std::make_unique<same_again>(input);
}
reference_pointer reference_sequence(extents3 input, std::vector<reference_pointer> layers) {
    return std::make_unique<sequence>(input, std::move(layers));
}
reference_pointer reference_residual(reference_pointer main, reference_pointer skip) {
    return std::make_unique<residual>(std::move(main), std::move(skip));
}

bounded rounded_once(bounded exact, double roundoff) {
    exact.error += accumulated(roundoff, 1) * magnitude(exact);
    exact.deviation = std::hypot(exact.deviation, roundoff * exact.value);
    return exact;
}

sample bounded_input(std::span<const float> counts, std::span<const float> mean, float scale) {
    sample in(counts.size());
    for (std::size_t i = 0; i < in.size(); ++i) {
        const double m = mean.empty() ? 0 : static_cast<double>(mean[i]);
        in[i].value = (static_cast<double>(counts[i]) - m) * static_cast<double>(scale);
        // Taking away nothing and multiplying by one do not round.
        const double size = m == 0 && scale == 1 ? 0 : std::abs(in[i].value);
        in[i].error = accumulated(deployed_roundoff, 2) * size + (size > 0 ? lost : 0),
        in[i].deviation = std::sqrt(2) * deployed_roundoff * size;
    }
    return in;
}

sample bounded_outputs(const described_network& network, const network_parameters& parameters,
                       const sample& in) {
    reference_call call = parameters;
    call.deployed = true;
    call.roundoff = deployed_roundoff;
    call.folded = network.folded;
    call.tiles = network.tiles;
    return network.layers->forward(call, {in}).front();
}

described_network as_trained(described_network network) {
    network.folded = false;
    network.tiles.clear();
    return network;
}

} // namespace support
