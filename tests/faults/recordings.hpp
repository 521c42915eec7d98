#pragma once

// Small recordings of every kind, and a network for a stream of them, without damage.

#include <map>
#include <string>

namespace faults {

/// By file name: sample.fsx, sample.csv, sample.mp, own.stream, plain.stream, stream.net.
std::map<std::string, std::string> recordings();

} // namespace faults
