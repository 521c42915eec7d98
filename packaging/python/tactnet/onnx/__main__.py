"""python3 -m tactnet.onnx model.onnx: writes a header with the network, its weights, and a report."""

import argparse
import sys


def main():
    parser = argparse.ArgumentParser(prog="python3 -m tactnet.onnx", description="Writes an ONNX model as a network of tactnet: "
                                     "NAME.hpp, NAME.safetensors with a self-test, and the report NAME.txt.")
    parser.add_argument("model", help="the ONNX file")
    parser.add_argument("--output", default=".", metavar="FOLDER", help="where the files go; default: here")
    parser.add_argument("--name", help="of the files and of the namespace; default: that of the ONNX file")
    parser.add_argument("--classes", metavar="A,B,…", help="names of the outputs; default: class_00, class_01, …")
    parser.add_argument("--scale", type=float, default=1.0, help="the model's input is (count - mean) x scale; default: 1")
    parser.add_argument("--mean", type=float, default=0.0, help="see --scale; default: 0")
    parser.add_argument("--shape", metavar="N,N,…", help="extents of the input, where the model leaves them open")
    parser.add_argument("--model-output", metavar="TENSOR", help="the output to import, of several")
    parser.add_argument("--fold", action="store_true", help="batch norms become part of the layers before them")
    options = parser.parse_args()
    try:
        from . import CannotImport, read
    except ImportError as error:
        sys.exit(f"python3 -m tactnet.onnx: needs the Python packages onnx and numpy (Debian: python3-onnx): {error}")
    try:
        shape = [int(n) for n in options.shape.split(",")] if options.shape else None
        network = read(options.model, options.name, classes=options.classes and options.classes.split(","), fold=options.fold,
                       scale=options.scale, mean=options.mean, shape=shape, output=options.model_output)
        print(network.save(options.output), end="")
    except (CannotImport, OSError, ValueError) as error:
        sys.exit(f"{options.model}: {' '.join(str(error).split())}")


if __name__ == "__main__":
    main()
