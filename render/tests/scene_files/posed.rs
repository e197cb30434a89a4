//! posed
