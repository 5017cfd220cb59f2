//! Division of the picture into tiles, blocks and pixel packets.

/// Rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Leftmost column.
    pub x: u32,
    /// Topmost row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Packet of eight neighbouring pixels, four wide and two high; some may lie outside the tile.
#[derive(Clone, Copy, Debug)]
pub struct PixelPacket {
    x: u32,
    y: u32,
}

/// Packets of a block of 8 by 8 pixels.
pub type Block = [PixelPacket; 8];

/// Edge of a block, in pixels.
const BLOCK: u32 = 8;

impl Tile {
    /// Returns the tiles of a picture, row by row, with `edge` (at least 1) pixels to a side where they fit.
    #[must_use]
    pub fn cover(width: u32, height: u32, edge: u32) -> Vec<Self> {
        let mut tiles = Vec::new();
        for y in (0..height).step_by(edge as usize) {
            for x in (0..width).step_by(edge as usize) {
                tiles.push(Self { x, y, width: edge.min(width - x), height: edge.min(height - y) });
            }
        }
        tiles
    }

    /// Returns the number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Fills `blocks` with blocks that cover the tile, in Morton order. Rays near each other in the stream are then
    /// near each other in the picture.
    pub fn blocks(&self, blocks: &mut Vec<Block>) {
        let starts = |extent: u32| (0..extent).step_by(BLOCK as usize);
        let corner = starts(self.height).flat_map(|y| starts(self.width).map(move |x| (self.x + x, self.y + y)));
        blocks.clear();
        blocks.extend(corner.map(|(x, y)| -> Block {
            std::array::from_fn(|i| PixelPacket { x: x + 4 * (i as u32 % 2), y: y + 2 * (i as u32 / 2) })
        }));
        blocks.sort_unstable_by_key(|[first, ..]| spread(first.x - self.x) | spread(first.y - self.y) << 1);
    }
}

/// Spreads the bits of `x`, with a zero above each (Morton 1966).
fn spread(x: u32) -> u64 {
    let part = |x: u64, by: u32, mask: u64| (x | x << by) & mask;
    let x = part(u64::from(x), 16, 0x0000_ffff_0000_ffff);
    let x = part(x, 8, 0x00ff_00ff_00ff_00ff);
    let x = part(x, 4, 0x0f0f_0f0f_0f0f_0f0f);
    let x = part(x, 2, 0x3333_3333_3333_3333);
    part(x, 1, 0x5555_5555_5555_5555)
}

impl PixelPacket {
    /// Returns the column of lane `k`.
    #[inline]
    #[must_use]
    pub fn x(&self, k: usize) -> u32 {
        self.x + k as u32 % 4
    }

    /// Returns the row of lane `k`.
    #[inline]
    #[must_use]
    pub fn y(&self, k: usize) -> u32 {
        self.y + k as u32 / 4
    }

    /// Returns the index of lane `k`'s pixel within the tile, row by row, or `None` if it lies outside.
    #[inline]
    #[must_use]
    pub fn pixel(&self, tile: &Tile, k: usize) -> Option<u32> {
        let (x, y) = (self.x(k) - tile.x, self.y(k) - tile.y);
        (x < tile.width && y < tile.height).then(|| y * tile.width + x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_and_their_packets_cover_every_pixel_once() {
        for (w, h, edge) in [(1, 1, 32), (7, 5, 3), (64, 64, 32), (33, 17, 16), (100, 3, 8), (9, 9, 100)] {
            let mut seen = vec![0; (w * h) as usize];
            for tile in Tile::cover(w, h, edge) {
                let mut numbers = Vec::new();
                let mut blocks = Vec::new();
                tile.blocks(&mut blocks);
                for packet in blocks.into_iter().flatten() {
                    for k in 0..8 {
                        if let Some(number) = packet.pixel(&tile, k) {
                            numbers.push(number);
                            seen[(packet.y(k) * w + packet.x(k)) as usize] += 1;
                        }
                    }
                }
                numbers.sort_unstable();
                assert!(numbers.into_iter().eq(0..tile.pixels() as u32));
            }
            assert!(seen.iter().all(|&n| n == 1), "{w} x {h} in tiles of {edge}");
        }
    }
}
