//! Compressed files of one grid of vertices, with streams that other programs made.

use crate::build::base64;

/// A buffer view as the extension describes it, with its stream in hexadecimal digits.
#[derive(Clone)]
pub struct View {
    pub stream: Vec<u8>,
    count: usize,
    stride: usize,
    mode: &'static str,
    filter: &'static str,
}

/// Two extensions with streams for each by meshoptimizer 1.3: positions, normals, coordinates, colours and
/// rotations.
pub const MESHOPT: [(&str, [&str; 5]); 2] = [
    (
        "EXT_meshopt_compression",
        [
            "a00003004000205f4000205f2020205f202020000138480000ca000100ccc0c0401f2020000138480000ca00010033\
             ffff1008171010102f181818000138480000ca00000000000000000000000000000000000000000000008e0000008e\
             0000008e",
            "a0020000f864fc88fcc831333303003121176c291d1760231b13541f17130000000000000000000000000000000000\
             0000000000000000000000000000007f00",
            "a00300aaaaaa02aaaaaa02aaaaaa02aaaaaa0300aaaaaa02aaaaaa02aaaaaa02aaaaaa0100c0c0c0aaaaaa0100c0c0\
             c0aaaaaa0000000000000000000000000000000000000000000000000000000000000000",
            "a003002a2c2a292a2a2a292a2c2a2b2a2c2a0300545654fd545654fd545654fd5456540300292929d4292b29d42929\
             29d229292900000000000000000000000000000000000000000000000000000000004081c0ff",
            "a000000130000000b101300000000a0000000000000000000000000000000000000000000000000000000000000000\
             0000ff07",
        ],
    ),
    (
        "KHR_meshopt_compression",
        [
            "a159666600020007020201320131313131005600d0707070005011401f20200138480000ca00a0ff1008171010102f\
             1818180138480000ca0000000000000000000000008e0000008e0000008e420000",
            "a1ad020000f864fc88fcc8313333003121176c291d1760231b13541f17130000000000000000000000000000000000\
             000000007f0000",
            "a15700aaaaaa02aaaaaa02aaaaaa02aaaaaa00eeeeaaaaaaaaaaaaaaaaaaaaaaaa001011aaaaaa001011aaaaaa0000\
             00000000000000000000000000000000000000000001",
            "a1bf002a2c2a292a2a2a292a2c2a2b2a2c2a00545654fd545654fd545654fd54565400292929d4292b29d4292929d2\
             292929000000000000000000000000000000000000004081c0ff00",
            "a1faaa00b1000a0000000000000000000000000000000000000000ff070000",
        ],
    ),
];

/// The indices of the grid's triangles, and of a strip of its first row.
const TRIANGLES: &str = "e1fe1e100e100e8e1e140e130e8e1e130e130e0f08007687566778a9866589689801690000";
const STRIP: &str = "d100100a100a100a1000000000";

/// Streams by Draco 1.5.7: by edgebreaker, and one vertex after another.
pub const DRACO: [&str; 2] = [
    "445241434f0202010100000010120312020006efd3ea53ad1aff0111ff026b41ff026b41ff026b4104ff000100000001000002\
     0000010009030000020101090300010301030902000202010202040003010101010106d70a01285501ffffffffff3f55015505\
     030104ad02ffffffffff4bad02ffffffffffffffffffffa35501ad02ad020fffa83098cd5f1e3ffecfe7da903e8400000000ff\
     070000000000000000000000000000000040400b060301000903011403010c01080b01180600b1c77bc29020e01f900f600f80\
     0f0e998601fa0406d803ff0000007f000000ff02114108050101000b030108030104070108011c010803010807000310eba63f\
     86aaaeaa6aaacba56ea8079cc08d0880029477d02680c321b80a000e0000001203f8308200000000ff03000000000000000000\
     000000803f0a0101010105ac0101390102ffff9b01010103010108003bfe7eae7e6f8600000000ff000000",
    "445241434f020201000000121001000104010504010205020605020306030706040508050908050609060a0906070a070b0a08\
     090c090d0c090a0d0a0e0d0a0b0e0b0f0e0104000903000001090300010309020002020204000302030201000101000c030104\
     23013c0300208ba02a00006055000080aa00008000a80a00aa02c02a56050055a80a00ab08c0aaffa32a0054655500a88aaa00\
     609500a8fa7faa02008056050000a90a00ff0100000000ff07000000030100091b0104013c0300208b807f8679843bc37cf253\
     843a03bcc27c3a0c43bb42bc41fdbb8ac2bbc1bc413dff0000007f0000000001010101ab05011c030106ffffffffffffffffff\
     ff9b011e08002d7c44ac85338200000000ff0300000001010101ab01012c01020103ffff9b010f0c8040bc4a99b36acc9e4ea8\
     9300000000ff000000000000000000000000000000000040400b0800000000000000000000803f0a",
];

/// The bytes that digits stand for.
pub fn bytes(hexadecimal: &str) -> Vec<u8> {
    let digits = hexadecimal.as_bytes().as_chunks::<2>().0;
    let byte = |digits: &[u8; 2]| {
        let text = std::str::from_utf8(digits).expect("digits");
        u8::from_str_radix(text, 16).expect("digits")
    };
    digits.iter().map(byte).collect()
}

/// The views of all streams of an extension.
pub fn views(streams: &[&str; 5]) -> Vec<View> {
    let filters = [
        ("EXPONENTIAL", 16, 12),
        ("OCTAHEDRAL", 16, 4),
        ("NONE", 16, 4),
        ("COLOR", 16, 4),
        ("QUATERNION", 2, 8),
    ];
    let attributes = streams.iter().zip(filters).map(|(stream, (filter, count, stride))| View {
        stream: bytes(stream),
        count,
        stride,
        mode: "ATTRIBUTES",
        filter,
    });
    let indices = [("TRIANGLES", TRIANGLES, 54), ("INDICES", STRIP, 8)].map(|(mode, stream, count)| View {
        stream: bytes(stream),
        count,
        stride: 2,
        mode,
        filter: "NONE",
    });
    attributes.chain(indices).collect()
}

/// A file of such views: the grid twice, turned about y by the rotations, and the strip. `fallback` is more
/// JSON of the buffer that views would be in.
pub fn meshopt(extension: &str, views: &[View], fallback: &str) -> String {
    let (mut packed, mut whole, mut json) = (Vec::new(), 0, Vec::new());
    for View { stream, count, stride, mode, filter } in views {
        let step = if *mode == "ATTRIBUTES" { format!(r#","byteStride":{stride}"#) } else { String::new() };
        json.push(format!(
            r#"{{"buffer":1,"byteOffset":{whole},"byteLength":{}{step},"extensions":{{
                "{extension}":{{"buffer":0,"byteOffset":{},"byteLength":{},"byteStride":{stride},
                "count":{count},"mode":"{mode}","filter":"{filter}"}}}}}}"#,
            count * stride,
            packed.len(),
            stream.len(),
        ));
        packed.extend_from_slice(stream);
        whole += (count * stride).next_multiple_of(4);
    }
    format!(
        r#"{{"asset":{{"version":"2.0"}},
        "extensionsUsed":["{extension}"],"extensionsRequired":["{extension}"],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}},
            {{"byteLength":{whole}{fallback}}}],
        "bufferViews":[{}],"accessors":[
            {{"bufferView":0,"componentType":5126,"count":16,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5120,"count":16,"type":"VEC3","normalized":true}},
            {{"bufferView":2,"componentType":5123,"count":16,"type":"VEC2","normalized":true}},
            {{"bufferView":3,"componentType":5121,"count":16,"type":"VEC4","normalized":true}},
            {{"bufferView":4,"componentType":5122,"count":2,"type":"VEC4","normalized":true}},
            {{"bufferView":5,"componentType":5123,"count":54,"type":"SCALAR"}},
            {{"bufferView":6,"componentType":5123,"count":8,"type":"SCALAR"}}],
        "nodes":[{{"mesh":1}},
            {{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"ROTATION":4}}}}}}}}],
        "meshes":[{{"primitives":[{{"indices":5,
                "attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}}}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":0}},"indices":6,"mode":5}}]}}]}}"#,
        packed.len(),
        base64(&packed),
        json.join(","),
    )
}

/// A file of a primitive by Draco. Colours are said to be floats, and the numbers of elements to be others.
pub fn draco(stream: &[u8]) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_draco_mesh_compression"],
        "buffers":[{{"byteLength":{length},"uri":"data:application/octet-stream;base64,{}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"accessors":[
            {{"componentType":5126,"count":16,"type":"VEC3"}},
            {{"componentType":5126,"count":16,"type":"VEC3"}},
            {{"componentType":5126,"count":16,"type":"VEC2"}},
            {{"componentType":5126,"count":16,"type":"VEC4","normalized":true}},
            {{"componentType":5123,"count":9,"type":"SCALAR"}}],
        "nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"indices":4,"mode":5,
            "attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}},
            "extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0,
                "attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}}}}}}}}]}}]}}"#,
        base64(stream),
        length = stream.len(),
    )
}
