// A walk through the tree over surfels, from left to right, to the leaves that may matter to a `Query`: those
// whose nodes, and all above, it `reaches`. Both are the pass's.

#import shared/surfel

// A place in the walk.
struct Walk {
    height: u32,
    index: u32,
}

// The next node that is not below this one.
fn after(walk: Walk) -> Walk {
    var next = Walk(walk.height, walk.index + 1u);
    while (next.index & 3u) == 0u && next.height < HEIGHT {
        next = Walk(next.height + 1u, next.index >> 2u);
    }
    return next;
}

// Whether there are surfels at or after a place.
fn goes_on(walk: Walk) -> bool {
    return (walk.height < HEIGHT || walk.index == 0u) && first_surfel(walk.height, walk.index) < totals.kept;
}

// From a place on, the first node of the height `leaves` that matters, if the walk goes on there. A loop of
// its own, so that all invocations of a workgroup look at leaves together.
fn next_leaf(start: Walk, leaves: u32, query: Query) -> Walk {
    var walk = start;
    while goes_on(walk) {
        if !reaches(nodes[node_index(walk.height, walk.index)], query) {
            walk = after(walk);
        } else if walk.height > leaves {
            walk = Walk(walk.height - 1u, 4u * walk.index);
        } else {
            break;
        }
    }
    return walk;
}
