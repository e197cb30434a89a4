//! deepshade-dataset
