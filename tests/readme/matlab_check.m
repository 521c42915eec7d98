% What docs/train/pytorch_and_matlab.md says of MATLAB, in GNU Octave: reads the file that PyTorch wrote, computes the logits of
% its self-test in MATLAB's order, writes the network again, and expects the same arrays.
arrays = from_tactnet('from_pytorch.safetensors', [2 4 32]);

% Layers as a trained network has them.
layers = struct('Mean', cell(1, 14), 'Weights', [], 'Bias', [], 'Scale', [], 'Offset', [], 'TrainedMean', [], ...
                'TrainedVariance', [], 'Epsilon', 1e-5);
layers(1).Mean = arrays.input_mean;
for i = 1:3
    layers(4 * i - 2).Weights = arrays.(sprintf('conv%d_weight', i));
    layers(4 * i - 2).Bias = reshape(arrays.(sprintf('conv%d_bias', i)), 1, 1, []);
    layers(4 * i - 1).Scale = reshape(arrays.(sprintf('bn%d_weight', i)), 1, 1, []);
    layers(4 * i - 1).Offset = reshape(arrays.(sprintf('bn%d_bias', i)), 1, 1, []);
    layers(4 * i - 1).TrainedMean = reshape(arrays.(sprintf('bn%d_running_mean', i)), 1, 1, []);
    layers(4 * i - 1).TrainedVariance = reshape(arrays.(sprintf('bn%d_running_var', i)), 1, 1, []);
end
layers(14).Weights = arrays.fc_weight;
layers(14).Bias = arrays.fc_bias;

% Images come as columns x rows x image, of which from_tactnet has exchanged the first two.
images = double(arrays.selftest_input);
expected = double(arrays.selftest_logits); % images x classes
for k = 1:size(expected, 1)
    x = images(:, :, k) - double(layers(1).Mean);
    for i = 1:3
        c = layers(4 * i - 2);
        n = layers(4 * i - 1);
        [kernel, ~, channels, filters] = size(c.Weights);
        before = floor((kernel - 1) / 2); % the odd zero goes to the bottom and to the right
        [rows, columns, ~] = size(x);
        padded = zeros(rows + kernel - 1, columns + kernel - 1, channels);
        padded(before + (1:rows), before + (1:columns), :) = x;
        y = zeros(rows, columns, filters);
        for f = 1:filters
            for channel = 1:channels
                y(:, :, f) += conv2(padded(:, :, channel), rot90(double(c.Weights(:, :, channel, f)), 2), 'valid');
            end
            y(:, :, f) = (y(:, :, f) + c.Bias(f) - n.TrainedMean(f)) / sqrt(n.TrainedVariance(f) + n.Epsilon) * n.Scale(f) + n.Offset(f);
        end
        y = max(y, 0);
        y(rows + 1 : 2 * ceil(rows / 2), :, :) = 0;
        y(:, columns + 1 : 2 * ceil(columns / 2), :) = 0;
        x = max(max(y(1:2:end, 1:2:end, :), y(2:2:end, 1:2:end, :)), max(y(1:2:end, 2:2:end, :), y(2:2:end, 2:2:end, :)));
    end
    found = double(layers(14).Weights) * x(:) + double(layers(14).Bias(:));
    assert(max(abs(found' - expected(k, :))) <= 1e-4 * max(abs(expected(:))));
end

to_tactnet('from_matlab.safetensors', layers, [2 4 32], {'ball', 'bar', 'hand'});
again = from_tactnet('from_matlab.safetensors', [2 4 32]);
names = fieldnames(again)';
assert(numel(names) == 21);
for name = names
    assert(isequal(again.(name{1}), arrays.(name{1})), name{1});
end
