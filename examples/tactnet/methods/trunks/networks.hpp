#pragma once

// The trunks there are: a network each, up to the layer that the paper's authors took features from, for
// photographs of the size it was trained on. Included by the generated units only, each of which compiles one
// of them. A new one is a struct here and its name in TACTNET_PROGRAM_TRUNKS.

#include "methods/trunks/compiled.hpp"

#include <tactnet/networks.hpp>

namespace trunks {

struct squeezenet {
    using network = tactnet::squeezenet1_1_trunk<tactnet::shape{227, 227, 3}>;
    static trunk_names names() {
        return {"squeezenet", "SqueezeNet 1.1", "fire9-concat", "squeezenet1_1", {"classifier."}};
    }
};

struct alexnet {
    using network = tactnet::alexnet_fc7<tactnet::shape{224, 224, 3}>;
    static trunk_names names() { return {"alexnet", "AlexNet", "fc7", "alexnet", {"classifier.6."}}; }
};

struct resnet50 {
    using network = tactnet::resnet50<tactnet::shape{224, 224, 3}>;
    static trunk_names names() { return {"resnet50", "ResNet-50", "fc1000", "resnet50", {}}; }
};

struct vgg16 {
    using network = tactnet::vgg16_fc6<tactnet::shape{224, 224, 3}>;
    static trunk_names names() {
        return {"vgg16", "VGG16", "fc6", "vgg16", {"classifier.3.", "classifier.6."}};
    }
};

} // namespace trunks
