#pragma once

#include <tactnet/tensor/aligned.hpp>

#include <cstring>

namespace support {

template <class T>
bool same_bits(const tactnet::aligned_vector<T>& a, const tactnet::aligned_vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

} // namespace support
