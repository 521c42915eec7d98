#!/usr/bin/env python3
"""What the library costs the compiler: seconds of processor time and memory for small files, from nothing at all to a deployed TactNet-6.

    compile_time.py COMPILER OPTION...          medians of 5 compilations; the target compile_time calls it with the options of the build
"""

import os
import pathlib
import statistics
import sys
import tempfile

INFER = """tactnet::frame_status infer(const deployed_network& d, tactnet::tensor_view<const float, network::input_shape> frame,
                            std::span<float, network::outputs> logits) {
    return d.infer(frame, logits);
}
"""
TACTNET6 = "tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>"
# A network of more than ten kinds of layers.
TEN_KINDS = """tactnet::network<tactnet::shape{28, 50, 1}, tactnet::conv2d<16, 3, 2>, tactnet::batch_norm, tactnet::hard_swish,
    tactnet::conv2d<16, 3, 1, tactnet::padding::same, tactnet::in_groups(16)>, tactnet::batch_norm, tactnet::relu,
    tactnet::squeeze_excitation<16, 4>, tactnet::conv2d<24, 1>, tactnet::max_pool<2>, tactnet::dilated_conv2d<24, 3>, tactnet::elu<>,
    tactnet::residual<tactnet::sequence<tactnet::conv2d<24, 3, 1, tactnet::padding::same, tactnet::in_groups(24)>,
        tactnet::layer_norm<tactnet::norm_over::channels>, tactnet::conv2d<48, 1>, tactnet::gelu, tactnet::conv2d<24, 1>>>,
    tactnet::global_average_pool, tactnet::dense<22>>"""


def deployed(network):
    return f"""#include <tactnet/tactnet.hpp>
using network = {network};
using deployed_network = tactnet::deployed<network>;
{INFER}deployed_network make(const network& n) {{ return tactnet::deploy(n); }}
"""


def loaded(header, result, call):
    """A network from a weight file: deployed, or as a model for further training."""
    return f"""#include <tactnet/io/{header}>
#include <tactnet/tactnet.hpp>
tactnet::{result}<{TACTNET6}> load(const char* path) {{ return tactnet::{call}<{TACTNET6}>(path); }}
"""


def in_8_bits(make):
    return f"""#include <tactnet/quantisation.hpp>
#include <tactnet/tactnet.hpp>
using network = {TACTNET6};
using deployed_network = tactnet::deployed<network, tactnet::eight_bit>;
{INFER}{make}
"""


def readme_example():
    text = (pathlib.Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
    return text.partition("```cpp\n")[2].partition("\n```")[0] + "\n"


UNITS = {
    "an empty file": "\n",
    "xsimd alone": "#if __has_include(<xsimd/xsimd.hpp>)\n#include <xsimd/xsimd.hpp>\n#endif\n",
    "the core included": "#include <tactnet/tactnet.hpp>\n",
    "files included": "#include <tactnet/io.hpp>\n",
    "README's example": readme_example(),
    "load_deployed, TactNet-6": loaded("deployed_file.hpp", "deployed", "load_deployed"),
    "load_model, TactNet-6": loaded("model_file.hpp", "model", "load_model"),
    "TactNet-4 28x50 deployed": deployed("tactnet::tactnet4<tactnet::shape{28, 50, 1}, 22>"),
    "TactNet-6 28x50 deployed": deployed(TACTNET6),
    # In 8 bits: from folded numbers, as files and headers have them, or calibrated, which runs the network in single precision too.
    "the same in 8 bits": in_8_bits("deployed_network make(std::span<const float, deployed_network::view_type::folded_elements> folded) "
                                    "{ return deployed_network(folded); }"),
    "the same, calibrated": in_8_bits(
        "deployed_network make(const network& n, std::span<const float, network::input_shape.size()> mean, std::span<const std::uint8_t> "
        "images) { return tactnet::deploy<tactnet::eight_bit>(n, mean, 1.0f, images); }"),
    "TactNet-6 10x18 deployed": deployed("tactnet::tactnet6<tactnet::shape{10, 18, 1}, 22>"),
    "more than ten kinds of layers": deployed(TEN_KINDS),
    "TactResNet 28x50 deployed": deployed("tactnet::tactresnet<tactnet::shape{28, 50, 1}, 22>"),
}


def compile_once(command):
    """Seconds and megabytes: the peak of the largest process, which is the compiler proper."""
    child = os.posix_spawnp(command[0], command, os.environ)
    _, status, used = os.wait4(child, 0)
    if status:
        sys.exit("the compiler failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    print(f"{'median of 5 compilations':30} {'seconds':>9} {'MB':>9} {'object, kB':>12}")
    with tempfile.TemporaryDirectory() as folder:
        source, output = pathlib.Path(folder, "unit.cpp"), pathlib.Path(folder, "unit.o")
        for name, text in UNITS.items():
            source.write_text(text)
            rounds = [compile_once([*sys.argv[1:], "-c", str(source), "-o", str(output)]) for _ in range(5)]
            seconds, megabytes = (statistics.median(column) for column in zip(*rounds))
            print(f"{name:30} {seconds:9.2f} {megabytes:9.0f} {output.stat().st_size / 1024:12.1f}", flush=True)
