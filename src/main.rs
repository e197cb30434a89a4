//! The program `deepshade`, which is the library of that name.

use std::process::Termination;

fn main() -> impl Termination {
    deepshade::main()
}
