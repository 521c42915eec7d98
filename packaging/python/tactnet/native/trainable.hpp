#pragma once

#include "described.hpp"

#include <tactnet/training/loop/trainable.hpp>

namespace tactnet_python {

template <class Network>
network_code code_of_trainable() {
    network_code code;
    code.facts = facts_of<Network>;
    code.trainable = []() -> std::unique_ptr<tactnet::trainable> {
        return std::make_unique<tactnet::trainable_network<Network>>();
    };
    return code;
}

} // namespace tactnet_python
