"""Times networks in PyTorch, eager and compiled, for `deepshade bench net` and `deepshade bench train`.

Reads a job as JSON from standard input and writes what it measured as JSON to standard output. The networks are the
same layers with random weights. On a CUDA device they run in half precision and the clock is CUDA's own.
"""

import json
import math
import statistics
import sys
import time

import torch
import torch.nn.functional as F


class Net(torch.nn.Module):
    """The layers of a network, as deepshade lists them."""

    def __init__(self, job):
        super().__init__()
        self.layers, self.leak, self.alignment = job["layers"], job["leak"], job["alignment"]
        self.convs = torch.nn.ModuleList(
            torch.nn.Conv2d(l["inputs"], l["outputs"], job["kernel"], padding=job["kernel"] // 2, groups=l["groups"])
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
        return made[-1][:, :, :height, :width]


def times(work, job, cuda):
    """Milliseconds of runs, after some that do not count: on a GPU half a second of them, in which it gets up to its clock."""
    for _ in range(2):
        work()
    began = time.perf_counter()
    while cuda and time.perf_counter() - began < 0.5:
        work()
        torch.cuda.synchronize()
    runs, start = [], time.perf_counter()
    while len(runs) < 3 or (len(runs) < job["runs"] and time.perf_counter() - start < job["seconds"]):
        if cuda:
            events = [torch.cuda.Event(enable_timing=True) for _ in range(2)]
            events[0].record()
            work()
            events[1].record()
            torch.cuda.synchronize()
            runs.append(events[0].elapsed_time(events[1]))
        else:
            began = time.perf_counter()
            work()
            runs.append((time.perf_counter() - began) * 1e3)
    runs.sort()
    return {"milliseconds": statistics.median(runs), "p95": runs[max(math.ceil(0.95 * len(runs)), 1) - 1]}


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
    half = "_half" if cuda else ""
    # With CUDA graphs, which spare small networks the cost of launching their kernels.
    mode = "reduce-overhead" if cuda else "default"
    engines = {f"pytorch{half}": net, f"pytorch_compiled{half}": torch.compile(net, mode=mode)}
    made = []
    width, height = job["size"]
    x = torch.randn(1, job["layers"][0]["inputs"], height, width, device=device, dtype=dtype)
    for name, engine in engines.items():
        with torch.inference_mode():
            made.append({"engine": name, **times(lambda: engine(x), job, cuda)})
    return made


def train(job, cuda):
    device = "cuda" if cuda else "cpu"
    net = Net(job)
    check(net, job)
    net = net.to(device)
    optimiser = torch.optim.AdamW(net.parameters(), lr=1e-4)
    shape = (job["batch"], job["layers"][0]["inputs"], job["crop"], job["crop"])
    x = torch.randn(shape, device=device)
    target = torch.rand(shape[0], job["layers"][-1]["outputs"], *shape[2:], device=device)

    def step():
        optimiser.zero_grad(set_to_none=True)
        dssim(net(x), target).backward()
        optimiser.step()

    return [{"engine": "pytorch", **times(step, job, cuda)}]


def main():
    job = json.load(sys.stdin)
    cuda = torch.cuda.is_available()
    if not cuda:
        torch.set_num_threads(job["threads"])
    made = train(job, cuda) if job["mode"] == "train" else infer(job, cuda)
    name = torch.cuda.get_device_name() if cuda else "CPU"
    json.dump({"version": torch.__version__, "device": name, "made": made}, sys.stdout)


main()
