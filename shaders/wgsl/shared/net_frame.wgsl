// What a pass before or after a network is told of the frame.

#uniform NetFrame

@group(0) @binding(0) var<uniform> frame: NetFrame;
