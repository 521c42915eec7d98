#pragma once

// Networks among the program's methods.

#include "methods/method.hpp"
#include "methods/networks/compiled.hpp"
#include "methods/networks/eight_bit/compiled.hpp"

#include <memory>
#include <optional>
#include <string_view>

/// `type`: of the network, without what is between the brackets: "tactnet::tactnet6". `published`: how the
/// network was trained where it was published, if it was. `bytes`: its form in 8 bits, or nothing.
std::unique_ptr<method> make_network_method(std::string_view name, std::unique_ptr<compiled_network> code,
                                            std::string_view type,
                                            std::optional<tactnet::published_training> published,
                                            std::unique_ptr<compiled_eight_bit> bytes = nullptr);
