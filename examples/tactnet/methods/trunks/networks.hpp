#pragma once

// The trunks there are: a network each, up to the layer that the paper's authors took features from, for
// photographs of the size it was trained on. Included by the generated units only, each of which compiles one
// of them. A new one is a struct here and its name in TACTNET_PROGRAM_TRUNKS.

#include "methods/trunks/compiled.hpp"

#include <tactnet/networks.hpp>

namespace trunks {

namespace known = photograph_networks;

struct squeezenet {
    using network = tactnet::squeezenet1_1_trunk<known::squeezenet.photograph>;
    static constexpr std::string_view head_method = "squeezenet-pooled-nn";
    static constexpr trunk_features_form head_features{trunk_pooling::pooled, true};
    static trunk_names names() { return {known::squeezenet, "fire9-concat", {"classifier."}}; }
};

struct alexnet {
    using network = tactnet::alexnet_fc7<known::alexnet.photograph>;
    static constexpr std::string_view head_method = "alexnet-fc7-nn";
    static constexpr trunk_features_form head_features{};
    static trunk_names names() { return {known::alexnet, "fc7", {"classifier.6."}}; }
};

struct resnet50 {
    using network = tactnet::resnet50<known::resnet50.photograph>;
    static constexpr std::string_view head_method = "resnet50-fc1000-nn";
    static constexpr trunk_features_form head_features{};
    static trunk_names names() { return {known::resnet50, "fc1000", {}}; }
};

struct vgg16 {
    using network = tactnet::vgg16_fc6<known::vgg16.photograph>;
    static constexpr std::string_view head_method = "vgg16-fc6-nn";
    static constexpr trunk_features_form head_features{};
    static trunk_names names() { return {known::vgg16, "fc6", {"classifier.3.", "classifier.6."}}; }
};

} // namespace trunks
