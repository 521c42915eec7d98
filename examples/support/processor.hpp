#pragma once

// Which processor this is, for measurements that are kept.

#include <algorithm>
#include <fstream>
#include <map>
#include <string>

/// The system's name for it, with family and model where they are known, since a virtual machine may call all
/// of a maker's processors the same: "AMD EPYC (family 26 model 2)". "unknown" where the system says nothing.
inline std::string processor_name() {
    std::ifstream file("/proc/cpuinfo");
    std::map<std::string, std::string> first; // of the first core
    for (std::string line; std::getline(file, line) && !line.empty();)
        if (const auto colon = line.find(':'); colon != std::string::npos)
            first.emplace(line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1),
                          line.substr(std::min(colon + 2, line.size())));
    std::string name = "unknown";
    if (first.contains("model name"))
        name = first["model name"];
    else if (first.contains("CPU implementer") && first.contains("CPU part")) // of ARM
        name = "implementer " + first["CPU implementer"] + " part " + first["CPU part"];
    if (first.contains("cpu family") && first.contains("model"))
        name += " (family " + first["cpu family"] + " model " + first["model"] + ")";
    std::replace(name.begin(), name.end(), ',', ' ');
    return name;
}
