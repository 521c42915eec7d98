#pragma once

// The methods that were compiled in.

#include "methods/method.hpp"

/// All of them, networks by name and then by size in front. Generated when configuring.
std::vector<std::unique_ptr<method>> make_methods();

/// The same, made once.
const std::vector<std::unique_ptr<method>>& all_methods();

/// `size`: 28x50. Throws usage_error with what there is.
const method& find_method(std::string_view name, std::string_view size);

/// Throws usage_error when a data folder has more classes than the method.
void check_capacity(const method& what, const std::string& data, std::size_t classes);

/// The method that is trained unless the user names one.
std::string default_method();

/// Each once: "tactnet4, tactnet6, …".
std::string method_names();
