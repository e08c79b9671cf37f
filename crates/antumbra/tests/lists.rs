//! Scan and sort on the GPU against the CPU: all lengths around the ends of threads, workgroups and blocks,
//! lists of a million, and lengths that only the GPU knows.

mod common;

use antumbra::Error;
use antumbra::gpu::readback::read_buffer;
use antumbra::gpu::recorder::Recorder;
use antumbra::gpu::resources::{Resources, storage_buffer};
use antumbra::passes::lists::list_length::ListLength;
use antumbra::passes::lists::scan::Scan;
use antumbra::passes::lists::sort::Sort;
use common::gpu;
use pollster::block_on;

/// Around 64 threads, a block of 1024, and several blocks a run; and none at all.
const LENGTHS: [u32; 22] =
    [0, 1, 2, 15, 16, 17, 63, 64, 65, 127, 128, 1023, 1024, 1025, 2047, 2048, 2049, 4095, 4096, 4097, 65_535, 65_537];

/// More than the blocks of one scan of runs, so that runs have several blocks.
const MANY: u32 = 1_048_576 + 321;

/// Room beyond the end, which nothing may touch.
const BEYOND: u32 = 70;

const UNTOUCHED: u32 = 0xdead_beef;

fn random_words(seed: u64, count: u32) -> Vec<u32> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 16) as u32
    };
    (0..count).map(|_| next()).collect()
}

/// A buffer that holds these words, and some that nothing may touch.
fn buffer_with(words: &[u32]) -> wgpu::Buffer {
    let mut all = words.to_vec();
    all.extend([UNTOUCHED; BEYOND as usize]);
    let buffer = storage_buffer(gpu(), "words", all.len() as u64 * 4);
    gpu().queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&all));
    buffer
}

fn words_of(buffer: &wgpu::Buffer) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), buffer)).expect("reads"))
}

/// A length that was counted on the GPU, as far as the passes can tell.
fn counted(count: u32) -> ListLength {
    let length = storage_buffer(gpu(), "length", 16);
    gpu().queue.write_buffer(&length, 0, bytemuck::cast_slice(&ListLength::words(count)));
    ListLength(length)
}

/// Records and submits; returns the handles that were recorded.
fn run<T>(record: impl FnOnce(&mut Recorder) -> Result<T, Error>) -> T {
    let (mut resources, mut made) = (Resources::default(), None);
    let result = common::submit(|encoder| {
        made = Some(record(&mut Recorder::new(gpu(), encoder, &mut resources))?);
        Ok(())
    });
    result.unwrap_or_else(|e| panic!("{e}"));
    made.expect("recorded")
}

/// Scans the first `length` words of a buffer; returns the total.
fn scanned(buffer: &wgpu::Buffer, length: u32, capacity: u32) -> Vec<u32> {
    let length = counted(length);
    let total = run(|recorder| {
        let scan = Scan::new(recorder, capacity);
        scan.record(recorder, "scan", &length, buffer)?;
        Ok(scan.total)
    });
    words_of(&total.0)
}

fn check_scan(values: &[u32], capacity: u32) {
    let buffer = buffer_with(values);
    let total = scanned(&buffer, values.len() as u32, capacity);
    let mut sum = 0u32;
    let mut before = |value: &u32| {
        let next = sum.wrapping_add(*value);
        std::mem::replace(&mut sum, next)
    };
    let mut expected: Vec<u32> = values.iter().map(&mut before).collect();
    expected.extend([UNTOUCHED; BEYOND as usize]);
    let got = words_of(&buffer);
    let wrong = (0..expected.len()).find(|&i| got[i] != expected[i]);
    let n = values.len();
    assert!(wrong.is_none(), "{n} of {capacity}: place {wrong:?} is {:?}", wrong.map(|i| (got[i], expected[i])));
    let groups = sum.div_ceil(64);
    assert_eq!(total, [groups.min(1 << 15), groups.div_ceil(1 << 15), 1, sum], "{n} of {capacity}: total");
}

#[test]
fn a_scan_sums_what_is_before() {
    for n in LENGTHS {
        let values: Vec<u32> = random_words(u64::from(n), n).iter().map(|w| w % 9).collect();
        check_scan(&values, n.max(1));
        // A list may be shorter than it was thought to be.
        check_scan(&values, 3 * n + 5000);
    }
    let many: Vec<u32> = random_words(1, MANY).iter().map(|w| w % 3000).collect();
    check_scan(&many, MANY);
    // Sums wrap around as those of the CPU do.
    check_scan(&random_words(2, 3000), 3000);
}

#[test]
fn a_length_beyond_the_buffer_is_cut_off_at_its_end() {
    let values = vec![1u32; 2000];
    let buffer = storage_buffer(gpu(), "words", 8000);
    gpu().queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&values));
    let total = scanned(&buffer, 1 << 30, 2000);
    assert_eq!(words_of(&buffer), (0..2000).collect::<Vec<u32>>());
    assert_eq!(total[3], 2000);
}

fn check_sort(keys: &[u32], bits: u32) {
    let n = keys.len() as u32;
    let values: Vec<u32> = (0..n).collect();
    let length = counted(n);
    let [keys_out, values_out] = run(|recorder| {
        let sort = Sort::new(recorder, n + 500);
        gpu().queue.write_buffer(&sort.input.keys, 0, bytemuck::cast_slice(keys));
        gpu().queue.write_buffer(&sort.input.values, 0, bytemuck::cast_slice(&values));
        let sorted = sort.record(recorder, "sort", &length, bits)?;
        Ok([sorted.keys.clone(), sorted.values.clone()])
    });
    let mut expected: Vec<(u32, u32)> = keys.iter().copied().zip(values).collect();
    // Stable, as the GPU's has to be.
    expected.sort_by_key(|(key, _)| *key);
    let got: Vec<(u32, u32)> = words_of(&keys_out).into_iter().zip(words_of(&values_out)).take(n as usize).collect();
    let wrong = (0..n as usize).find(|&i| got[i] != expected[i]);
    assert!(wrong.is_none(), "{n} keys of {bits} bits: place {wrong:?} is {:?}", wrong.map(|i| (got[i], expected[i])));
}

#[test]
fn a_sort_orders_keys_and_keeps_the_order_of_equal_ones() {
    for n in LENGTHS {
        // Few keys, so that many are equal.
        check_sort(&random_words(u64::from(n) + 7, n).iter().map(|w| w % 37).collect::<Vec<_>>(), 6);
        check_sort(&random_words(u64::from(n) + 8, n), 32);
    }
    check_sort(&random_words(3, 1_000_000), 32);
    check_sort(&vec![5; 5000], 4);
    check_sort(&(0..5000).rev().collect::<Vec<_>>(), 13);
    check_sort(&[u32::MAX, 0, u32::MAX, 1], 32);
}
