"""Times networks in PyTorch, eager and compiled, for `deepshade bench net` and `deepshade bench train`.

Reads a job as JSON from standard input and writes what it measured as JSON to standard output. The networks have the
layers and the weights of the job. On a CUDA device they run in half precision and the clock is CUDA's own: as in
`gpu::time` all runs are queued before the first is waited for. Of channels first and channels last the faster counts.
"""

import copy
import json
import math
import statistics
import sys
import time

import torch
import torch.nn.functional as F


FORMATS = (torch.contiguous_format, torch.channels_last)


class Net(torch.nn.Module):
    """The layers of a network, as deepshade lists them."""

    def __init__(self, job):
        super().__init__()
        self.layers, self.leak, self.alignment = job["layers"], job["leak"], job["alignment"]
        self.filter, self.lights = job["filter"], job["lights"]
        self.correction, self.estimate, self.square = job["correction"], job["estimate"], job["square"]
        self.convs = torch.nn.ModuleList(
            torch.nn.Conv2d(l["inputs"], l["outputs"], l["kernel"], padding=l["kernel"] // 2, groups=l["groups"])
            for l in self.layers
        )
        for i, layer in enumerate(self.layers):
            order = layer.get("order")
            if order is not None:
                self.register_buffer(f"order{i}", torch.tensor(order) if order != sorted(order) else None)

    def forward(self, x):
        height, width = x.shape[2:]
        pad = (-width % self.alignment, -height % self.alignment)
        if any(pad):
            x = F.pad(x, (0, pad[0], 0, pad[1]), mode="replicate")
        made = []
        for i, (layer, conv) in enumerate(zip(self.layers, self.convs)):
            kind, of = layer["source"], layer["of"]
            if kind == "input":
                read = x
            elif kind == "folded":
                read = torch.cat([x[:, :, i // 2 :: 2, i % 2 :: 2] for i in range(4)], 1)
            elif kind == "plain":
                read = made[of[0]]
            elif kind == "pooled":
                read = F.avg_pool2d(made[of[0]], 2)
            else:
                doubled = F.interpolate(made[of[0]], scale_factor=2, mode="bilinear", align_corners=False)
                read = torch.cat((doubled, made[of[1]]), 1)
                order = getattr(self, f"order{i}")
                read = read if order is None else read.index_select(1, order)
            sums = conv(read)
            made.append(F.leaky_relu(sums, self.leak) if layer["activation"] else sums)
        made = self.unfolded(made[-1])[:, :, :height, :width]
        if self.correction is not None:
            return self.corrected(x, made)
        return made if self.filter is None else self.filtered(x[:, self.lights], made)

    def unfolded(self, made):
        """The pixels of squares, which are channels, in their places."""
        batch, channels, height, width = made.shape
        side, channels = self.square, channels // self.square**2
        made = made.reshape(batch, side, side, channels, height, width).permute(0, 3, 4, 1, 5, 2)
        return made.reshape(batch, channels, side * height, side * width)

    def corrected(self, x, made):
        """An estimate with a bias or a gain and weights of how far pixels around are from it."""
        height, width = made.shape[2:]
        estimate = x[:, self.estimate][:, :, :height, :width]
        gain, half_gate = self.correction["gain"], self.correction["half_gate"]
        biases = 0 if gain else estimate.shape[1]
        image = estimate + (made[:, -1:] * estimate if gain else made[:, :biases])
        light = x[:, self.lights]
        for tap, there in enumerate(self.taps(self.correction, light, made), biases):
            image = image + made[:, tap : tap + 1] * (there - estimate)
        if half_gate is not None:
            difference = (light[:, :, :height, :width] - estimate).abs().amax(1, keepdim=True)
            image = estimate + difference / (difference + half_gate) * (image - estimate)
        return image.clamp(*self.correction["range"])

    def taps(self, filter, light, made):
        """What every tap reads of a pyramid of an image."""
        height, width = made.shape[2:]
        size = filter["kernel"]
        for level in range(filter["levels"]):
            # A pixel more than kernels see, so that no tap is interpolated at the edge of what is doubled.
            wide = F.pad(light, [size // 2 + 1] * 4, mode="replicate")
            scale = 2**level
            doubled = F.interpolate(wide, scale_factor=scale, mode="bilinear", align_corners=False) if level else wide
            for y in range(size):
                for x in range(size):
                    top, left = scale * (y + 1), scale * (x + 1)
                    yield doubled[:, :, top : top + height, left : left + width]
            light = F.avg_pool2d(light, 2)

    def filtered(self, light, made):
        """The light weighted by predicted kernels; `infer/src/filter.rs` says what is computed."""
        # One more than there are taps, where one is of black.
        weights, image = made.softmax(1), 0.0
        for weight, there in zip(weights.split(1, 1), self.taps(self.filter, light, made)):
            image = image + weight * there
        return image


def by_events(work, count):
    """Milliseconds of runs on a GPU, which queues them all."""
    events = [[torch.cuda.Event(enable_timing=True) for _ in range(2)] for _ in range(count)]
    for before, after in events:
        before.record()
        work()
        after.record()
    torch.cuda.synchronize()
    return [before.elapsed_time(after) for before, after in events]


def by_clock(work, count):
    """Milliseconds of runs on the processor."""
    runs = []
    for _ in range(count):
        began = time.perf_counter()
        work()
        runs.append((time.perf_counter() - began) * 1e3)
    return runs


def times(work, job, cuda):
    """Milliseconds of runs, after some that do not count: on a GPU half a second of them, in which it gets up to its clock."""
    measure = by_events if cuda else by_clock
    measure(work, 2)
    began = time.perf_counter()
    while cuda and time.perf_counter() - began < 0.5:
        measure(work, 8)
    fitting = int(job["seconds"] * 1e3 / measure(work, 1)[0])
    runs = sorted(measure(work, max(min(fitting, job["runs"]), 3)))
    return {"milliseconds": statistics.median(runs), "p95": runs[max(math.ceil(0.95 * len(runs)), 1) - 1]}


def fastest(engine, prepare, job, cuda):
    """The times of an engine in the memory format that suits it better; `prepare` gives what runs in a format."""
    made = []
    for memory_format in FORMATS:
        # What was compiled for one format must not stand for all.
        torch._dynamo.reset()
        made.append(times(prepare(memory_format), job, cuda))
    return {"engine": engine, **min(made, key=lambda row: row["milliseconds"])}


def check(net, job):
    """Ends the program if the network is not the one that was meant."""
    with torch.no_grad():
        for conv, (weight, bias) in zip(net.convs, job["weights"]):
            conv.weight.copy_(torch.tensor(weight).reshape(conv.weight.shape))
            conv.bias.copy_(torch.tensor(bias))
        width, height = job["check"]["size"]
        made = net(torch.tensor(job["check"]["input"]).reshape(1, -1, height, width))
        difference = (made.flatten() - torch.tensor(job["check"]["output"])).abs().max().item()
    if not difference < 1e-3:
        sys.exit(f"PyTorch makes another image, which differs by {difference}")


def dssim(a, b):
    """Structural dissimilarity over tiles of 8x8 pixels."""
    mean = lambda x: F.avg_pool2d(x, 8)
    ma, mb = mean(a), mean(b)
    va, vb, cov = mean(a * a) - ma * ma, mean(b * b) - mb * mb, mean(a * b) - ma * mb
    c1, c2 = 0.01**2, 0.03**2
    ssim = (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
    return ((1 - ssim) / 2).mean()


def infer(job, cuda):
    device, dtype = ("cuda", torch.float16) if cuda else ("cpu", torch.float32)
    net = Net(job).eval()
    check(net, job)
    net = net.to(device, dtype)
    width, height = job["size"]
    input = torch.randn(1, job["layers"][0]["inputs"], height, width, device=device, dtype=dtype)

    def prepared(as_engine):
        def prepare(memory_format):
            engine, x = as_engine(net.to(memory_format=memory_format)), input.to(memory_format=memory_format)
            return lambda: engine(x)

        return prepare

    half = "_half" if cuda else ""
    # With CUDA graphs, which spare small networks the cost of launching their kernels.
    mode = "reduce-overhead" if cuda else "default"
    engines = {"pytorch": lambda net: net, "pytorch_compiled": lambda net: torch.compile(net, mode=mode)}
    with torch.inference_mode():
        return [fastest(name + half, prepared(engine), job, cuda) for name, engine in engines.items()]


def train(job, cuda):
    device = "cuda" if cuda else "cpu"
    first = Net(job)
    check(first, job)
    shape = (job["batch"], job["layers"][0]["inputs"], job["crop"], job["crop"])
    input = torch.randn(shape, device=device)
    target = torch.rand(shape[0], job["layers"][-1]["outputs"], *shape[2:], device=device)

    def prepared(as_loss):
        def prepare(memory_format):
            net = copy.deepcopy(first).to(device, memory_format=memory_format)
            optimiser = torch.optim.AdamW(net.parameters(), lr=1e-4)
            loss = as_loss(lambda x: dssim(net(x), target))
            x = input.to(memory_format=memory_format)

            def step():
                optimiser.zero_grad(set_to_none=True)
                loss(x).backward()
                optimiser.step()

            return step

        return prepare

    engines = {"pytorch": lambda loss: loss, "pytorch_compiled": torch.compile}
    return [fastest(name, prepared(engine), job, cuda) for name, engine in engines.items()]


def main():
    job = json.load(sys.stdin)
    cuda = torch.cuda.is_available()
    # cuDNN's fastest kernels, which it finds by measuring, as ours are found.
    torch.backends.cudnn.benchmark = True
    if not cuda:
        torch.set_num_threads(job["threads"])
    made = train(job, cuda) if job["mode"] == "train" else infer(job, cuda)
    name = torch.cuda.get_device_name() if cuda else "CPU"
    json.dump({"version": torch.__version__, "device": name, "made": made}, sys.stdout)


main()
